/* Shows the scenes that flatgrasp put into this page. Every text is set as text, never as markup. */
const SCENES = JSON.parse(document.getElementById("scenes").textContent);
const PHASES = ["pre_grasp", "grasp", "lift"];
const ORANGE = 0xe69f00, BLUE = 0x56b4e9, RED = 0xd55e00, GREY = 0x8a949c, GREEN = 0x009e73;
const PICK_PX = 14;  // a click so near to a grasp's closing line means it
const by = (id) => document.getElementById(id);
const vector = (xyz) => new THREE.Vector3(...xyz);
const state = { frame: 0, grasp: null, phase: "grasp", pointPx: 2, showCloud: true };
const clouds = new Map();  // by frame: a promise of its points
let renderer, camera, eye, dirty = true, scene = null, grasps = [], labels = [], points = null, hands = null;

function complain(text) {
  by("help").textContent = text;
  by("help").classList.add("error");
}

function make(tag, parent, text, kind) {
  const element = document.createElement(tag);
  if (text !== undefined) element.textContent = text;
  if (kind) element.className = kind;
  parent.append(element);
  return element;
}
