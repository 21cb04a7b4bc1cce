// Episodes of the chosen run in three dimensions: those of its newest controller, or one of them beside that of a changed design.
import { cost } from "./panels.js";
import { ask } from "./server.js";
import { el, short, tell } from "./words.js";

const PATIENCE = 250; // ms without a further change before a design is simulated

export class Robot {
  // `learned`: is told the design of the controller that is shown, by parameter.
  constructor({ stages, note, costs, follow }, learned) {
    Object.assign(this, { stages, note, costs, follow, learned, viewers: [], busy: null, shown: "", wanted: new Map(), detail: null });
    follow.addEventListener("change", () => this.update());
  }

  // The run that is looked at, as it is now.
  show(detail) {
    if (this.detail?.curve.epoch !== detail.curve.epoch || this.detail?.index !== detail.index) this.clear();
    this.detail = detail;
    this.update();
  }

  // Another design is wanted, by parameter, SI; the trained one where none is named.
  want(wanted) {
    this.wanted = new Map(wanted);
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.update(), wanted.size === 0 ? 0 : PATIENCE);
  }

  clear() {
    this.request?.abort();
    clearTimeout(this.timer);
    this.setStages(0);
    Object.assign(this, { request: null, busy: null, shown: "", wanted: new Map() });
    this.costs.hidden = true;
    this.costs.replaceChildren();
    tell(this.note, "");
  }

  update() {
    const { detail } = this;
    if (!detail) return;
    if (!detail.simulates) return tell(this.note, "Its episodes cannot be simulated here.");
    const query = new URLSearchParams([...this.wanted].map(([name, value]) => [name, String(value)])).toString();
    const wish = `${detail.index} ${detail.curve.epoch} ${query}`, policy = detail.policy;
    const due = wish !== this.shownWish || (policy !== this.shownPolicy && this.follow.checked);
    const asked = `${wish} ${policy}`;
    // What began with a checkpoint comes to its end with it; only then a newer one is taken.
    if (wish === this.busy || asked === this.shown || (!due && this.shown)) return;
    this.request?.abort();
    this.request = new AbortController();
    this.busy = wish;
    const { signal } = this.request;
    if (!this.shown || query) tell(this.note, "Simulating …");
    const path = `/api/runs/${detail.index}/${query ? `what-if?${query}` : "episode"}`;
    ask(path, { signal }).then(
      async (answer) => {
        Object.assign(this, { shown: asked, shownWish: wish, shownPolicy: policy });
        if (query) await this.compared(answer, `/api/runs/${detail.index}/cost/${answer.policy}?${query}`, signal);
        else this.episodes(answer);
        if (signal.aborted) return;
        this.busy = null;
        this.update();
      },
      (error) => {
        if (error.name === "AbortError") return;
        this.busy = null;
        // What cannot be simulated is not asked for again; what was too much at once, or had no answer, is.
        if ([0, 503, 504].includes(error.status)) return;
        Object.assign(this, { shown: asked, shownWish: wish, shownPolicy: policy });
        tell(this.note, `No episode: ${error.message}.`);
      },
    );
  }

  // How far a controller is.
  when({ policy, env_steps: steps }) {
    return policy === "first" ? "as it begins, before training" : steps === null ? "as trained" : `after ${short(steps)} steps of training`;
  }

  told(answer, what) {
    return `The controller ${this.when(answer)}, ${what}`;
  }

  episodes(answer) {
    this.costs.hidden = true;
    this.learned(answer.design);
    if (answer.scene.takes.length === 0) {
      this.setStages(0);
      return tell(this.note, "This problem does not show itself; its curves tell how it does.");
    }
    tell(this.note, `${this.told(answer, "on held-out starts")} (seed ${answer.seed}).`);
    this.setStages(1, answer.scene);
  }

  compared(answer, costs, signal) {
    this.learned(answer.before.design);
    const seen = answer.before.scene.takes.length > 0 && answer.after.scene.takes.length > 0;
    tell(this.note, this.told(answer, "with the trained and with the changed design."));
    if (seen) this.setStages(2, answer.before.scene, answer.after.scene);
    else this.setStages(0);
    this.costs.hidden = false;
    this.costs.classList.add("old");
    if (this.costs.childElementCount === 0) this.costs.textContent = "Counting what it costs …";
    return ask(costs, { signal }).then(
      (judged) => {
        cost(this.costs, judged, this.when(answer));
        this.costs.classList.remove("old");
      },
      (error) => {
        if (error.name !== "AbortError") tell(this.costs, `What it costs is not known: ${error.message}.`);
      },
    );
  }

  // Shows so many scenes side by side; what shows already goes on with the new ones.
  setStages(many, ...scenes) {
    if (this.viewers.length === many) return this.viewers.forEach((viewer, i) => viewer.setScene(scenes[i]));
    this.viewers.forEach((viewer) => viewer.destroy());
    this.viewers = [];
    const names = many === 2 ? ["as trained", "changed"] : [""];
    const frames = scenes.map((_, i) => el("div", { className: "stage" }));
    this.stages.replaceChildren(...scenes.map((_, i) => el("div", {}, names[i] ? el("h3", {}, names[i]) : null, frames[i])));
    this.stages.className = many === 2 ? "two" : "";
    scenes.forEach((scene, i) => {
      const label = `The robot ${names[i]}`.trim();
      this.viewers.push(globalThis.hwaspViewer(frames[i], scene, { sync: this.viewers[0], controls: i === 0, label }));
    });
  }
}
