/* --- the cloud: base64, deflate, byte planes of zigzag differences --- */

async function unpacked(frame) {
  const about = SCENES[frame].cloud, holder = by("cloud-" + frame);
  if (!about || !holder) return null;
  const bytes = Uint8Array.from(atob(holder.textContent), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  const raw = new Uint8Array(await new Response(stream).arrayBuffer());
  const n = about.count, place = new Float32Array(3 * n), color = new Uint8Array(3 * n);
  for (let axis = 0; axis < 3; axis++) {
    for (let k = 0, step = 0; k < n; k++) {
      const zigzag = raw[axis * n + k] | raw[(3 + axis) * n + k] << 8;
      step = step + ((zigzag >> 1) ^ -(zigzag & 1)) & 0xffff;
      place[3 * k + axis] = about.low[axis] - SCENES[frame].middle[axis] + about.step * step;
    }
    for (let k = 0, value = 0; about.colored && k < n; k++) {
      value = value + raw[(6 + axis) * n + k] & 0xff;
      color[3 * k + axis] = value;
    }
  }
  if (!about.colored) shade(place, color, SCENES[frame]);
  return { place, color };
}

function shade(place, color, about) {  // grey by height, lighter the higher
  const up = about.up, span = about.radius;
  for (let k = 0; k < place.length; k += 3) {
    const height = (place[k] * up[0] + place[k + 1] * up[1] + place[k + 2] * up[2]) / span;
    color.fill(Math.max(50, Math.min(235, 150 + 160 * height)), k, k + 3);
  }
}

async function showCloud(frame) {
  if (!clouds.has(frame)) clouds.set(frame, unpacked(frame));
  const cloud = await clouds.get(frame).catch(() => complain("This browser is too old to unpack the cloud."));
  if (frame !== state.frame || !cloud) return;
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(cloud.place, 3));
  geometry.setAttribute("color", new THREE.BufferAttribute(cloud.color, 3, true));
  points = new THREE.Points(geometry, new THREE.PointsMaterial(
    { size: state.pointPx * devicePixelRatio, sizeAttenuation: false, vertexColors: true }));
  points.visible = state.showCloud;
  scene.add(points);
  dirty = true;
}
