/* --- what stands in the scene; its origin is the middle of what is looked at --- */

function lines(places, color, closed, parent) {
  const geometry = new THREE.BufferGeometry().setFromPoints(places);
  const kind = closed ? THREE.LineLoop : THREE.Line;
  const line = new kind(geometry, new THREE.LineBasicMaterial({ color, depthTest: false, transparent: true }));
  line.renderOrder = 2;
  (parent || scene).add(line);
  return line;
}

function stick(from, to, radius, color, opacity, parent) {
  const way = to.clone().sub(from);
  const mesh = new THREE.Mesh(new THREE.CylinderGeometry(radius, radius, way.length(), 12),
    new THREE.MeshBasicMaterial({ color, transparent: true, opacity, depthWrite: false }));
  mesh.position.copy(from).addScaledVector(way, 0.5);
  mesh.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), way.normalize());
  parent.add(mesh);
}

function hand(boxes, wrist, pose, solid, color, parent) {
  const group = new THREE.Group();
  group.position.copy(local(pose.position));
  group.quaternion.set(...pose.orientation);
  if (wrist[0][2] - wrist[1][2] > 1e-3) stick(...wrist.map(vector), 0.018, GREY, solid ? 0.5 : 0.12, group);
  for (const [center, size] of boxes) {
    const box = new THREE.BoxGeometry(...size);
    const edges = new THREE.LineSegments(new THREE.EdgesGeometry(box),
      new THREE.LineBasicMaterial({ color: solid ? 0x3a2800 : color, transparent: true, opacity: solid ? 1 : 0.7 }));
    edges.position.set(...center);
    group.add(edges);
    if (!solid) continue;
    const palm = center === boxes[boxes.length - 1][0];  // one sees the fingers through it
    const mesh = new THREE.Mesh(box, new THREE.MeshBasicMaterial({ color, transparent: true, opacity: palm ? 0.3 : 0.85,
      depthWrite: !palm, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 }));
    mesh.position.set(...center);
    group.add(mesh);
  }
  parent.add(group);
}

function local(place) { return vector(place).sub(vector(SCENES[state.frame].middle)); }

function forget(things) {  // what the graphics card holds of them is not found as garbage
  things.traverse((thing) => {
    if (thing.geometry) thing.geometry.dispose();
    if (thing.material) thing.material.dispose();
  });
}

function build() {
  const about = SCENES[state.frame];
  if (scene) forget(scene);
  scene = new THREE.Scene();
  points = hands = null;
  if (about.plane) {
    const [a, b, c, d] = about.plane.map(local);
    const geometry = new THREE.BufferGeometry().setFromPoints([a, b, c, a, c, d]);
    scene.add(new THREE.Mesh(geometry, new THREE.MeshBasicMaterial(
      { color: GREEN, transparent: true, opacity: 0.14, side: THREE.DoubleSide, depthWrite: false })));
  }
  by("labels").replaceChildren();
  labels = [];
  for (const thing of about.objects) {
    for (const loop of thing.loops) lines(loop.map(local), thing.grasps.length ? BLUE : GREY, true);
    if (thing.loops.length) {
      const middle = thing.loops[0].map(local).reduce((sum, place) => sum.add(place), new THREE.Vector3());
      labels.push({ place: middle.divideScalar(thing.loops[0].length), element: make("span", by("labels"), thing.id) });
    }
  }
  for (const grasp of grasps) grasp.line = lines(grasp.contacts.map(local), RED, false);
  showCloud(state.frame);
}

function showHands() {
  if (!scene) return;
  if (hands) {
    scene.remove(hands);
    forget(hands);
  }
  hands = new THREE.Group();
  scene.add(hands);
  for (const grasp of grasps) grasp.line.material.opacity = grasp === state.grasp ? 1 : 0.6;
  const grasp = state.grasp;
  if (grasp) {
    for (const phase of PHASES) {
      const boxes = phase === "pre_grasp" ? grasp.open : grasp.closed, solid = phase === state.phase;
      hand(boxes, grasp.wrist, grasp.poses[phase], solid, solid ? ORANGE : 0xd0d6db, hands);
      const arm = grasp.arm && grasp.arm[phase].map(local);
      for (let k = 1; arm && k < arm.length; k++)
        if (arm[k].distanceTo(arm[k - 1]) > 1e-4) stick(arm[k - 1], arm[k], 0.025, BLUE, solid ? 0.55 : 0.12, hands);
    }
    lines(PHASES.map((phase) => local(grasp.poses[phase].position)), 0xd0d6db, false, hands);
    stick(...grasp.contacts.map(local), 0.0015, RED, 1, hands);
  }
  dirty = true;
}
