// The camera by hand: one finger or the left button turns it; two fingers or the right button move it; wheel and pinch zoom.
// `view` has turn(across, up), in rad; move(across, down), in pixels; zoom(factor); and what keys do, by their names.
const handle = (canvas, view) => {
  const pointers = new Map();
  const on = (name, act, options) => canvas.addEventListener(name, act, options);
  on("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    canvas.focus({ preventScroll: true });
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
  });
  on("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const now = [event.clientX, event.clientY], [x, y] = [now[0] - before[0], now[1] - before[1]];
    pointers.set(event.pointerId, now);
    if (pointers.size === 2) {
      const [, other] = [...pointers].find(([id]) => id !== event.pointerId);
      const apart = (at) => Math.hypot(at[0] - other[0], at[1] - other[1]) || 1;
      view.zoom(apart(before) / apart(now));
      view.move(x / 2, y / 2);
    } else if (event.buttons & 6 || event.shiftKey) view.move(x, y);
    else view.turn(0.008 * x, 0.008 * y);
  });
  for (const name of ["pointerup", "pointercancel"]) on(name, (event) => pointers.delete(event.pointerId));
  on("contextmenu", (event) => event.preventDefault());
  on("wheel", (event) => {
    // The wheel scrolls a long page until the picture is clicked.
    if (document.activeElement !== canvas && document.documentElement.scrollHeight > innerHeight) return;
    event.preventDefault();
    view.zoom(Math.exp(event.deltaY * (event.deltaMode ? 0.03 : 0.001)));
  }, { passive: false });
  on("keydown", (event) => {
    const does = view.keys[event.key];
    if (!does || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    does();
  });
};
