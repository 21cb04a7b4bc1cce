// Shows scenes of hwasp in three dimensions. A page calls
//
//   const viewer = hwaspViewer(element, scene, options);
//
// with the JSON of a Scene. The viewer builds picture and controls inside the element. Options, all of which may be left out:
//   take      the episode to begin with, counted from 0
//   autoplay  whether it begins by itself (true); it never does for those who want less motion
//   controls  whether there are buttons and a slider (true)
//   sync      another viewer: both have one time, one episode and one camera
//   label     what the picture is called by screen readers; the title of the scene otherwise
// It gives setScene(scene), choose(take), seek(seconds), play(), stop(), destroy(), and onframe, a function to be set: it is
// called with (seconds, take) after every picture.

const REST = 1.2; // seconds that the last moment is shown
const SLOW = 45; // ms from picture to picture, above which they become coarser while they move

const make = (name, attributes = {}, ...inside) => {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...inside);
  return made;
};
const button = (text, kind = "") => make("button", { type: "button", class: kind }, text);
const verdict = ({ success }) => (success === undefined ? "" : success ? "success" : "failure");

globalThis.hwaspViewer = (element, first, { take: begin, autoplay = true, controls = true, sync, label } = {}) => {
  // What viewers beside each other share. Zoom and pan are relative to the picture that fits.
  const state = sync?.state ?? { take: 0, time: 0, playing: false, began: undefined, follow: true, members: new Set(), camera: undefined };
  let scene = read(first), gpu, asked = 0, lost = false, seen = true, dead = false;
  let quality = 1, pace = 0, last = 0;

  const canvas = make("canvas", { tabindex: 0, role: "application" });
  const choices = make("div", { class: "hw-row", role: "group", "aria-label": "Which episode" });
  const play = button("Play", "hw-play"), follow = button("Follow"), reset = button("Reset view");
  const slider = make("input", { type: "range", min: 0, step: 0.01, "aria-label": "Time" });
  const clock = make("span", { class: "hw-clock" }), about = make("p", { class: "hw-about" });
  const frame = make("div", { class: "hw-stage" }, canvas);
  const row = make("div", { class: "hw-row" }, play, make("label", {}, slider), clock, follow, reset);
  const root = make("div", { class: "hw" }, ...(controls ? [choices, frame, row] : [frame]), about);
  element.append(root);
  const gl = canvas.getContext("webgl2", { antialias: true });
  if (!gl) {
    frame.replaceChildren(make("p", { role: "status" },
      "This browser cannot draw in three dimensions: WebGL 2 is missing or turned off. A current Firefox, Chrome, Edge or Safari has it."));
  }

  const members = (what) => [...state.members].map((member) => member[what]);
  const tell = () => members("changed").forEach((changed) => changed());
  const end = () => Math.max(...members("end").map((own) => own()), 0);
  const chosen = () => clamp(state.take, 0, scene.takes.length - 1);
  const take = () => scene.takes[chosen()];
  const resetView = () => (state.camera = { turn: scene.shot.turn, rise: scene.shot.rise, zoom: 1, pan: [0, 0, 0] });
  const fitted = (aspect) => fitting(scene.shot, aspect);
  const distance = () => Math.max(...members("fitted").map((own) => own(canvas.clientWidth / canvas.clientHeight || 1))) * state.camera.zoom;

  const show = () => {
    const scale = Math.min(devicePixelRatio, 2) * (state.playing ? quality : 1);
    const size = [canvas.clientWidth, canvas.clientHeight].map((side) => Math.max(Math.round(side * scale), 1));
    if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
    gpu ??= stage(gl, scene);
    const { solids, cords, times } = take(), { camera } = state, { shot } = scene, at = when(times, state.time);
    const path = shot.centres[chosen()], [from, to] = state.follow ? [path[at[0]], path[at[1]]] : [path[0], path[0]];
    const floor = linear(getComputedStyle(root).getPropertyValue("--hw-floor").match(/[0-9a-f]{2}/gi).map((part) => parseInt(part, 16)));
    draw(gl, gpu, {
      solids, cords, at, shot, size, scale, floor, turn: camera.turn, rise: camera.rise, distance: distance(),
      target: add(add(from, add(to, from, -1), at[2]), camera.pan),
    });
  };

  const refresh = () => {
    const { times, told, worth, end } = take(), [k, next, share] = when(times, state.time), i = share > 0.5 ? next : k;
    slider.value = state.time;
    clock.textContent = `${Math.min(state.time, end).toFixed(2)} s, ${told[i] || `return ${words(worth[i])}`}`;
    slider.setAttribute("aria-valuetext", clock.textContent);
  };
  // Buttons and texts of a scene.
  const build = () => {
    canvas.setAttribute("aria-label", `${label ?? scene.title}: a picture in three dimensions. Arrows turn it, plus and minus zoom, Home resets it, space plays and stops.`);
    choices.replaceChildren(...scene.takes.map((one, i) => {
      const choice = button(one.name || `episode ${one.index}`), word = verdict(one);
      if (word) choice.append(" ", make("span", { class: one.success ? "hw-good" : "hw-bad" }, word));
      choice.addEventListener("click", () => viewer.choose(i));
      return choice;
    }));
    choices.hidden = scene.takes.length < 2;
    follow.hidden = !scene.shot.follows;
  };
  const changed = () => {
    if (dead) return;
    const one = take();
    if (!one) {
      about.textContent = "There is no episode.";
      return;
    }
    [...choices.children].forEach((choice, i) => choice.setAttribute("aria-pressed", String(i === chosen())));
    about.textContent = [
      `Episode ${one.index}`, one.kind, one.about, verdict(one), `return ${words(one.return)}`, one.discounted_return !== one.return && `discounted ${words(one.discounted_return)}`,
      `${one.steps} steps`, one.solids.some((solid) => solid.ground) && `squares of ${length(squares(scene.shot))} on the ground`,
    ].filter(Boolean).join(", ") + ".";
    slider.max = Math.ceil(100 * end()) / 100;
    play.textContent = state.playing ? "Stop" : "Play";
    follow.setAttribute("aria-pressed", String(state.follow));
    refresh();
    asked ||= requestAnimationFrame(tick);
  };
  const tick = (now) => {
    asked = 0;
    if (dead || !take()) return;
    // The mean of some pictures; one that was long ago does not count.
    if (now - last < 1000) pace += 0.1 * (now - last - pace);
    last = state.playing ? now : 0;
    if (pace > SLOW && quality > 0.5) [quality, pace] = [0.75 * quality, 0];
    if (state.playing) {
      state.began ??= now - 1000 * state.time;
      if (now - state.began > 1000 * (end() + REST)) state.began = now;
      state.time = clamp((now - state.began) / 1000, 0, end());
      refresh();
      asked = requestAnimationFrame(tick);
    }
    if (gl && !lost && seen) {
      show();
      viewer.onframe?.(state.time, chosen());
    }
  };
  const go = (changes) => {
    Object.assign(state, changes, { began: undefined });
    tell();
  };

  const viewer = {
    state,
    onframe: undefined,
    setScene: (next) => {
      scene = read(next);
      gpu?.setScene(scene);
      build();
      go({ time: Math.min(state.time, end()) });
    },
    choose: (index) => go({ take: index, time: 0 }),
    seek: (seconds) => go({ time: clamp(seconds, 0, end()) }),
    play: () => go({ playing: true, time: state.time < end() ? state.time : 0 }),
    stop: () => go({ playing: false }),
    destroy: () => {
      dead = true;
      state.members.delete(member);
      cancelAnimationFrame(asked);
      sized.disconnect();
      watched.disconnect();
      calm.removeEventListener("change", viewer.stop);
      gl?.getExtension("WEBGL_lose_context")?.loseContext();
      root.remove();
    },
  };
  const member = { changed, fitted, end: () => take()?.end ?? 0 };
  state.members.add(member);
  if (!state.camera) resetView();

  const toggle = () => (state.playing ? viewer.stop() : viewer.play());
  const view = {
    turn: (across, up) => {
      state.camera.turn -= across;
      state.camera.rise = clamp(state.camera.rise + up, -1.5, 1.55);
      tell();
    },
    move: (x, y) => {
      const [right, up] = directions(state.camera.turn, state.camera.rise);
      const metres = (2 * Math.tan(LENS / 2) * distance()) / canvas.clientHeight;
      state.camera.pan = add(add(state.camera.pan, right, -x * metres), up, y * metres);
      tell();
    },
    zoom: (factor) => {
      state.camera.zoom = clamp(state.camera.zoom * factor, 0.05, 20);
      tell();
    },
    reset: () => {
      resetView();
      tell();
    },
  };
  view.keys = {
    ArrowLeft: () => view.turn(-0.1, 0), ArrowRight: () => view.turn(0.1, 0), ArrowUp: () => view.turn(0, 0.1), ArrowDown: () => view.turn(0, -0.1),
    "+": () => view.zoom(0.9), "=": () => view.zoom(0.9), "-": () => view.zoom(1 / 0.9), Home: view.reset, " ": toggle,
  };
  handle(canvas, view);
  play.addEventListener("click", toggle);
  reset.addEventListener("click", view.reset);
  follow.addEventListener("click", () => go({ follow: !state.follow }));
  slider.addEventListener("input", () => go({ playing: false, time: clamp(Number(slider.value), 0, end()) }));
  slider.addEventListener("keydown", (event) => {
    if (event.key !== " ") return;
    event.preventDefault();
    toggle();
  });
  canvas.addEventListener("webglcontextlost", (event) => {
    event.preventDefault();
    lost = true;
  });
  canvas.addEventListener("webglcontextrestored", () => {
    [lost, gpu] = [false, undefined];
    changed();
  });
  const sized = new ResizeObserver(changed);
  sized.observe(frame);
  const watched = new IntersectionObserver((entries) => {
    seen = entries.at(-1).isIntersecting;
    changed();
  });
  watched.observe(frame);
  // Nothing moves by itself for those who want less motion.
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  calm.addEventListener("change", viewer.stop);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", changed);
  build();
  if (begin !== undefined) state.take = begin;
  if (autoplay && !calm.matches && !sync) viewer.play();
  else tell();
  return viewer;
};
