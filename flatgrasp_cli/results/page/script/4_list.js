/* --- the list --- */

function rows(parent, pairs, kind) {
  for (const pair of pairs) {
    const row = make("tr", parent, undefined, kind);
    for (const text of pair) make("td", row, text);
  }
}

function list() {
  const about = SCENES[state.frame], parent = by("objects");
  by("name").textContent = about.name;
  by("about").textContent = [about.topic, "frame " + about.frame_id, about.gripper, about.robot].filter(Boolean).join(" · ");
  by("notes").replaceChildren();
  for (const note of about.notes) make("p", by("notes"), note, "bad");
  for (const warning of about.warnings) make("p", by("notes"), warning, "warning");
  parent.replaceChildren();
  grasps = [];
  for (const thing of about.objects) {
    make("h2", parent, "object " + thing.id);
    for (const why of thing.why) make("p", parent, why, "why");
    for (const grasp of thing.grasps) {
      grasp.button = make("button", parent, undefined, "grasp");
      make("span", grasp.button, "#" + grasp.rank, "rank");
      if (grasp.holds) make("span", grasp.button, grasp.holds, "holds");
      make("span", grasp.button, "opens to " + grasp.opens);
      grasp.details = make("table", parent);
      grasp.button.addEventListener("click", () => select(grasp));
      grasps.push(grasp);
    }
    const stages = make("details", parent, undefined, "stages");
    make("summary", stages, "how many candidates each stage kept");
    rows(make("table", stages), thing.stages);
  }
}

function select(grasp, scroll) {
  state.grasp = grasp;
  for (const each of grasps) {
    each.button.setAttribute("aria-pressed", each === grasp);
    each.details.replaceChildren();
  }
  if (grasp) {
    rows(grasp.details, grasp.rows);
    rows(grasp.details, grasp.causes.map(([name, share]) => ["may fail: " + name, share]), "cause");
    if (scroll) grasp.button.scrollIntoView({ block: "nearest" });
  }
  showHands();
}

function setPhase(phase) {
  state.phase = phase;
  for (const button of by("phases").children) button.setAttribute("aria-pressed", button.dataset.phase === phase);
  showHands();
}

function setFrame(frame) {
  state.frame = Math.max(0, Math.min(SCENES.length - 1, frame));
  by("frame").value = state.frame;
  by("number").textContent = state.frame + 1 + " of " + SCENES.length;
  list();
  if (renderer) build();
  select(grasps[0] || null);
}
