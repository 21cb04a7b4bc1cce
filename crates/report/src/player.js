// Plays the drawn grasps: every picture is a path for each slot of the drawing. Without it the stills tell the same.
(() => {
  "use strict";
  const REST = 1.2; // seconds that the last picture is shown
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  for (const player of document.querySelectorAll(".player")) {
    const reels = JSON.parse(player.querySelector("script").textContent);
    const step = Number(player.dataset.step);
    const slots = [...player.querySelectorAll("[data-slot]")];
    const object = player.querySelector(".object");
    const takes = [...player.querySelectorAll(".takes button")];
    const play = player.querySelector(".play");
    const slider = player.querySelector("input");
    const clock = player.querySelector(".clock");
    let reel = reels[0];
    let playing = false;
    let began = 0;

    const show = (at) => {
      const paths = reel.frames[at].split("|");
      for (const slot of slots) slot.setAttribute("d", paths[slot.dataset.slot]);
      slider.value = at;
      const told = `${(at * step).toFixed(2)} s, ${reel.height[at]} mm above the floor`;
      slider.setAttribute("aria-valuetext", told);
      clock.textContent = told;
    };
    const last = () => reel.frames.length - 1;
    const tick = (now) => {
      if (!playing) return;
      if (!began) began = now - slider.value * step * 1000;
      const seconds = (now - began) / 1000;
      show(Math.min(Math.floor(seconds / step), last()));
      if (seconds > last() * step + REST) began = now;
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
      object.dataset.kind = reel.kind;
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
