// Plays the drawn episodes: every picture is a path for each slot of the drawing. Without it the stills tell the same.
(() => {
  "use strict";
  const REST = 1.2; // seconds that the last picture is shown
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  for (const player of document.querySelectorAll(".player")) {
    // Corner, order, and paths of every picture; what is empty is as it was before.
    const reels = JSON.parse(player.querySelector("script").textContent).map((reel) => {
      let before = [];
      const frames = reel.frames.map((frame) => (before = frame.split("|").map((part, i) => part || before[i])));
      return { ...reel, frames };
    });
    const camera = player.querySelector(".camera");
    const solids = player.querySelector(".solids");
    const slots = {};
    for (const slot of solids.children) slots[slot.dataset.slot] = slot;
    const takes = [...player.querySelectorAll(".takes button")];
    const play = player.querySelector(".play");
    const slider = player.querySelector("input");
    const clock = player.querySelector(".clock");
    let reel = reels[0];
    let painted;
    let playing = false;
    let began = 0;

    const show = (at) => {
      const [corner, order, ...paths] = reel.frames[at];
      camera.setAttribute("transform", `translate(${corner.split(" ").map((x) => -x).join(" ")})`);
      for (const [slot, path] of Object.entries(slots)) path.setAttribute("d", paths[slot]);
      if (order !== painted) solids.append(...(order ?? "").split(" ").filter(Boolean).map((slot) => slots[slot]));
      painted = order;
      slider.value = at;
      const told = `${reel.times[at].toFixed(2)} s, ${reel.told[at]}`;
      slider.setAttribute("aria-valuetext", told);
      clock.textContent = told;
    };
    const last = () => reel.frames.length - 1;
    const tick = (now) => {
      if (!playing) return;
      if (!began) began = now - reel.times[slider.value] * 1000;
      const seconds = (now - began) / 1000;
      const next = reel.times.findIndex((time) => time > seconds);
      show(next < 0 ? last() : Math.max(next - 1, 0));
      if (seconds > reel.times[last()] + REST) began = now;
      requestAnimationFrame(tick);
    };
    const go = (on) => {
      playing = on;
      began = 0;
      play.textContent = on ? "Stop" : "Play";
      if (!on) return;
      if (Number(slider.value) === last()) slider.value = 0;
      requestAnimationFrame(tick);
    };
    const choose = (i, at) => {
      reel = reels[i];
      takes.forEach((take, j) => take.setAttribute("aria-pressed", String(i === j)));
      slider.max = last();
      began = 0;
      show(Math.min(at, last()));
    };
    takes.forEach((take, i) => take.addEventListener("click", () => choose(i, 0)));
    play.addEventListener("click", () => go(!playing));
    slider.addEventListener("input", () => {
      go(false);
      show(Number(slider.value));
    });
    calm.addEventListener("change", () => go(false));
    player.hidden = false;
    choose(0, Math.floor(last() / 2));
    // It begins by itself once it is seen, but not for those who do not want things to move.
    if (!calm.matches) {
      new IntersectionObserver((seen, watch) => {
        if (!seen.some((entry) => entry.isIntersecting)) return;
        watch.disconnect();
        choose(0, 0);
        go(true);
      }, { threshold: 0.5 }).observe(player);
    }
  }
})();
