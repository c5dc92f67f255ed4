/* --- looking --- */

function resetEye() {
  const about = SCENES[state.frame], up = vector(about.up).normalize();
  let toward = about.sensor ? local(about.sensor).normalize() : up.clone();
  let level = toward.clone().addScaledVector(up, -toward.dot(up));
  if (level.length() < 0.05) level = new THREE.Vector3(0, -1, 0).addScaledVector(up, up.y);
  if (level.length() < 0.05) level = new THREE.Vector3(1, 0, 0).addScaledVector(up, -up.x);
  level.normalize();
  eye = { target: new THREE.Vector3(), up, level, side: up.clone().cross(level), yaw: 0.35, pitch: 0.75,
    distance: 2.1 * about.radius };
  dirty = true;
}

function place() {
  const flat = Math.cos(eye.pitch) * eye.distance;
  camera.position.copy(eye.target).addScaledVector(eye.level, flat * Math.cos(eye.yaw))
    .addScaledVector(eye.side, flat * Math.sin(eye.yaw)).addScaledVector(eye.up, Math.sin(eye.pitch) * eye.distance);
  camera.up.copy(eye.up);
  camera.near = eye.distance / 200;
  camera.far = eye.distance * 50 + 100;
  camera.lookAt(eye.target);
  const { clientWidth: width, clientHeight: height } = by("view");
  renderer.setPixelRatio(devicePixelRatio);
  renderer.setSize(width, height, false);
  camera.aspect = width / Math.max(1, height);
  camera.updateProjectionMatrix();
}

function onScreen(position) {
  const { clientWidth: width, clientHeight: height } = by("view"), seen = position.clone().project(camera);
  return { x: (seen.x + 1) / 2 * width, y: (1 - seen.y) / 2 * height, hidden: seen.z > 1 };
}

function draw() {
  requestAnimationFrame(draw);
  if (!dirty) return;
  dirty = false;
  place();
  renderer.render(scene, camera);
  for (const label of labels) {
    const { x, y, hidden } = onScreen(label.place);
    label.element.style.left = x + "px";
    label.element.style.top = y + "px";
    label.element.hidden = hidden;
  }
  if (points || !SCENES[state.frame].cloud) document.body.dataset.drawn = Math.round(performance.now());
}

function pick(x, y) {
  let nearest = null, least = PICK_PX;
  for (const grasp of grasps) {
    const [a, b] = grasp.contacts.map((contact) => onScreen(local(contact)));
    const dx = b.x - a.x, dy = b.y - a.y, along = ((x - a.x) * dx + (y - a.y) * dy) / Math.max(1e-9, dx * dx + dy * dy);
    const t = Math.max(0, Math.min(1, along)), away = Math.hypot(a.x + t * dx - x, a.y + t * dy - y);
    if (away < least) [nearest, least] = [grasp, away];
  }
  if (nearest) select(nearest, true);
}

function listen() {
  const canvas = by("canvas");
  let moved = 0;
  canvas.addEventListener("pointerdown", (event) => { moved = 0; canvas.setPointerCapture(event.pointerId); });
  canvas.addEventListener("pointermove", (event) => {
    if (!event.buttons) return;
    const dx = event.movementX, dy = event.movementY;
    moved += Math.abs(dx) + Math.abs(dy);
    if (event.buttons === 1 && !event.shiftKey) {
      eye.yaw -= 0.006 * dx;
      eye.pitch = Math.max(-1.5, Math.min(1.5, eye.pitch + 0.006 * dy));
    } else {
      const metres = eye.distance * 0.8 / by("view").clientHeight, [right, above] = [0, 1].map((column) =>
        new THREE.Vector3().setFromMatrixColumn(camera.matrix, column));
      eye.target.addScaledVector(right, -dx * metres).addScaledVector(above, dy * metres);
    }
    dirty = true;
  });
  canvas.addEventListener("pointerup", (event) => { if (moved < 4) pick(event.offsetX, event.offsetY); });
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    eye.distance *= Math.exp(0.001 * event.deltaY);
    dirty = true;
  }, { passive: false });
  addEventListener("resize", () => { dirty = true; });
}

function onKey(event) {
  if (event.ctrlKey || event.altKey || event.metaKey || event.target === by("frame")) return;
  const at = grasps.indexOf(state.grasp), key = event.key.toLowerCase();
  const near = (step) => grasps.length && select(grasps[(at + step + grasps.length) % grasps.length], true);
  const size = (step) => { state.pointPx = Math.max(1, state.pointPx + step);
    if (points) points.material.size = state.pointPx * devicePixelRatio; };
  const keys = { arrowdown: () => near(1), arrowup: () => near(-1), arrowright: () => setFrame(state.frame + 1),
    arrowleft: () => setFrame(state.frame - 1), 1: () => setPhase("pre_grasp"), 2: () => setPhase("grasp"),
    3: () => setPhase("lift"), "[": () => size(-1), "]": () => size(1), r: resetEye,
    c: () => { state.showCloud = !state.showCloud; if (points) points.visible = state.showCloud; } };
  if (!keys[key]) return;
  event.preventDefault();
  keys[key]();
  dirty = true;
}

function start() {
  by("frame").max = SCENES.length - 1;
  by("times").hidden = SCENES.length < 2;
  by("frame").addEventListener("input", () => setFrame(Number(by("frame").value)));
  for (const button of by("phases").children) button.addEventListener("click", () => setPhase(button.dataset.phase));
  addEventListener("keydown", onKey);
  try {
    renderer = new THREE.WebGLRenderer({ canvas: by("canvas"), antialias: true, alpha: true });
    camera = new THREE.PerspectiveCamera(40, 1, 0.01, 100);
  } catch (error) {
    complain("This browser does not draw in three dimensions (WebGL); the list works all the same.");
  }
  if (renderer) { resetEye(); listen(); }
  setFrame(0);
  setPhase("grasp");
  if (renderer) draw();
  document.body.dataset.ready = Math.round(performance.now());
}

start();
