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
"use strict";
globalThis.hwaspViewer = (() => {
  const REST = 1.2; // seconds that the last moment is shown
  const LENS = 0.6; // angle of the picture from top to bottom, rad
  const SHADOW = 1024; // pixels of a side of the map of shadows
  const SMOOTH = 4; // moments over which the way of the camera is smoothed, to either side
  const FOLLOWED = 3; // what goes so many times its own size is followed

  const VERTEX = `#version 300 es
    layout(location = 0) in vec4 at; // on the shape of size 1; w: which end of a capsule it belongs to
    layout(location = 1) in vec3 out_;
    uniform mat4 view, sun, pose;
    uniform vec3 size, shift;
    uniform float stretch;
    out vec3 place, normal, own, lit;
    void main() {
      own = at.xyz * size + vec3(0, 0, stretch * at.w) + shift;
      vec4 world = pose * vec4(own, 1);
      place = world.xyz;
      normal = mat3(pose) * (out_ / size);
      lit = (sun * world).xyz * 0.5 + 0.5;
      gl_Position = view * world;
    }`;
  const DARK = `#version 300 es
    precision mediump float;
    void main() {}`;
  const PAINT = `#version 300 es
    precision highp float;
    precision highp sampler2DShadow;
    in vec3 place, normal, own, lit;
    uniform vec4 colour;
    uniform vec3 eye, target, towards;
    uniform float squares, reach; // edge of the squares of ground, and where ground ends
    uniform sampler2DShadow shadow;
    out vec4 paint;
    void main() {
      vec3 n = normalize(normal), v = normalize(eye - place);
      if (dot(n, v) < 0.0 && !gl_FrontFacing) n = -n;
      vec3 base = pow(colour.rgb, vec3(2.2));
      float alpha = colour.a, shine = 0.25;
      if (squares > 0.0) {
        vec2 q = own.xy / squares, w = fwidth(q) + 1e-4;
        vec2 i = 2.0 * (abs(fract((q - 0.5 * w) * 0.5) - 0.5) - abs(fract((q + 0.5 * w) * 0.5) - 0.5)) / w;
        base = mix(base, vec3(0.8), 0.55) * (1.0 - 0.14 * (0.5 - 0.5 * i.x * i.y));
        alpha *= 1.0 - smoothstep(0.25 * reach, reach, distance(place, target));
        shine = 0.0;
      }
      float light = 1.0;
      if (all(greaterThan(lit, vec3(0))) && all(lessThan(lit, vec3(1)))) {
        light = 0.0;
        for (int i = 0; i < 4; i++)
          light += 0.25 * texture(shadow, vec3(lit.xy + (vec2(i & 1, i >> 1) * 2.0 - 1.0) * ${(0.8 / SHADOW).toFixed(6)}, lit.z - 0.002));
      }
      float facing = max(dot(n, towards), 0.0);
      vec3 sky = mix(vec3(0.30, 0.27, 0.25), vec3(0.50, 0.54, 0.60), 0.5 + 0.5 * n.z);
      vec3 c = base * (sky + vec3(0.72, 0.69, 0.64) * light * facing);
      c += shine * light * pow(max(dot(n, normalize(towards + v)), 0.0), 40.0) * step(0.001, facing);
      paint = vec4(pow(min(c, 1.0), vec3(0.4545)) * alpha, alpha);
    }`;

  // Vectors, and matrices of 4 × 4, column by column.
  const add = (a, b, t = 1) => [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = (a) => add([0, 0, 0], a, 1 / (Math.hypot(...a) || 1));
  const times = (a, b) => {
    const c = new Float32Array(16);
    for (let i = 0; i < 16; i++) for (let k = 0; k < 4; k++) c[i] += a[(i & 3) + 4 * k] * b[(i & 12) + k];
    return c;
  };
  const seenFrom = (eye, [right, up, back]) => [
    right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0,
    -dot(right, eye), -dot(up, eye), -dot(back, eye), 1];
  // Right, up, and towards the eye, for a direction from the x axis towards y, and up.
  const directions = (turn, rise) => {
    const [c, s, run, up] = [Math.cos(turn), Math.sin(turn), Math.cos(rise), Math.sin(rise)];
    return [[-s, c, 0], [-up * c, -up * s, run], [run * c, run * s, up]];
  };
  const lens = (aspect, near, far) => {
    const f = 1 / Math.tan(LENS / 2);
    return [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, (2 * far * near) / (near - far), 0];
  };
  const matrix = ([px, py, pz, x, y, z, w]) => [
    1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w), 0,
    2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w), 0,
    2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y), 0, px, py, pz, 1];
  // The pose of what leads along its z axis from one point to another.
  const along = (from, to) => {
    const z = unit(add(to, from, -1));
    const x = unit(cross(Math.abs(z[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0], z));
    return [...x, 0, ...cross(z, x), 0, ...z, 0, ...add(from, to).map((part) => part / 2), 1];
  };
  // 1, 2 or 5 times a power of ten, not above a length.
  const round = (length) => {
    const power = 10 ** Math.floor(Math.log10(Math.max(length, 1e-9)));
    return power * [5, 2, 1].find((digit) => digit * power <= length * 1.0001);
  };
  const clamp = (x, low, high) => Math.min(Math.max(x, low), high);
  const words = (x) => (Number.isFinite(x) ? x.toFixed(clamp(2 - Math.floor(Math.log10(Math.abs(x) || 1)), 0, 4)) : "not finite");
  const length = (m) => (m < 1 ? `${+(1000 * m).toPrecision(3)} mm` : `${+m.toPrecision(3)} m`);
  const decode = (text, Kind) => {
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    return new Kind(bytes.buffer);
  };

  // Shapes of size 1: seven numbers a point (place, end, normal), and the points of triangles.
  const lathe = (profile, sides) => {
    const points = [], faces = [];
    profile.forEach(([r, z, nr, nz, end], row) => {
      for (let i = 0; i <= sides; i++) {
        const [c, s] = [Math.cos((2 * Math.PI * i) / sides), Math.sin((2 * Math.PI * i) / sides)];
        points.push(r * c, r * s, z, end, nr * c, nr * s, nz);
        const a = row * (sides + 1) + i, b = a + sides + 1;
        if (row + 1 < profile.length && i < sides) faces.push(a, a + 1, b + 1, a, b + 1, b);
      }
    });
    return [points, faces];
  };
  const round_ = (sides) => {
    const half = sides >> 2, profile = [];
    for (const end of [-1, 1]) {
      for (let i = 0; i <= half; i++) {
        const angle = (Math.PI / 2) * (end < 0 ? i / half - 1 : i / half);
        profile.push([Math.cos(angle), Math.sin(angle), Math.cos(angle), Math.sin(angle), end]);
      }
    }
    return lathe(profile, sides);
  };
  const cylinder = () =>
    lathe([[0, -1, 0, -1, 0], [1, -1, 0, -1, 0], [1, -1, 1, 0, 0], [1, 1, 1, 0, 0], [1, 1, 0, 1, 0], [0, 1, 0, 1, 0]], 40);
  const box = (sides) => {
    const points = [], faces = [];
    for (const [axis, side] of sides) {
      const first = points.length / 7;
      for (const [u, v] of [[-1, -1], [1, -1], [1, 1], [-1, 1]]) {
        const at = [0, 0, 0], out = [0, 0, 0];
        at[axis] = out[axis] = side;
        at[(axis + 1) % 3] = u * side;
        at[(axis + 2) % 3] = v;
        points.push(...at, 0, ...out);
      }
      faces.push(first, first + 1, first + 2, first, first + 2, first + 3);
    }
    return [points, faces];
  };
  // Edges that turn by less than 45 degrees are smooth.
  const surface = ({ points, faces }) => {
    const at = (i) => points.subarray(3 * i, 3 * i + 3);
    const normals = [], around = new Map(), out = [];
    for (let f = 0; f < faces.length; f += 3) {
      const [a, b, c] = [at(faces[f]), at(faces[f + 1]), at(faces[f + 2])];
      normals.push(cross(add(b, a, -1), add(c, a, -1)));
      for (let k = 0; k < 3; k++) around.set(faces[f + k], [...(around.get(faces[f + k]) ?? []), f / 3]);
    }
    const units = normals.map(unit);
    faces.forEach((point, i) => {
      const own = units[Math.floor(i / 3)];
      const near = around.get(point).filter((f) => dot(units[f], own) > 0.7);
      out.push(...at(point), 0, ...unit(near.reduce((sum, f) => add(sum, normals[f]), [0, 0, 0])));
    });
    return [out, [...faces.keys()]];
  };

  // A scene with its numbers read, and where things are.
  const read = (scene) => {
    const surfaces = scene.surfaces.map((s) => ({ points: decode(s.points, Float32Array), faces: decode(s.faces, Uint16Array) }));
    const takes = scene.takes.map((take) => ({
      ...take,
      end: take.times.at(-1) ?? 0,
      solids: take.solids.map((solid) => ({
        ...solid,
        ground: solid.form === "plane" || solid.form === "field",
        rgb: solid.colour.map((part) => part / 255),
        poses: decode(solid.poses, Float32Array),
        sizes: decode(solid.sizes, Float32Array),
      })),
      cords: take.cords.map((cord) => ({ rgb: cord.colour.map((part) => part / 255), ways: ways(decode(cord.ways, Float32Array)) })),
    }));
    return { ...scene, surfaces, takes, shot: shot(takes, surfaces) };
  };
  const ways = (numbers) => {
    const moments = [];
    let i = 0;
    while (i < numbers.length) {
      const parts = [];
      for (let left = numbers[i++]; left > 0; left--) {
        const points = [];
        for (let more = numbers[i++]; more > 0; more--, i += 3) points.push([numbers[i], numbers[i + 1], numbers[i + 2]]);
        parts.push(points);
      }
      moments.push(parts);
    }
    return moments;
  };
  // The numbers of moment k, `of` of them.
  const moment = (numbers, of, k) => numbers.subarray(...(numbers.length > of ? [of * k, of * k + of] : [0, of]));

  // The box of a solid at moment k: its middle and half its edges, along the axes of the world.
  const bounds = (solid, surfaces, k) => {
    const pose = moment(solid.poses, 7, k);
    let size = [...moment(solid.sizes, 3, k)];
    if (solid.form === "capsule") size[2] += size[0];
    if (solid.form === "mesh") size = surfaces[solid.surface].points.reduce((most, x, i) => ((most[i % 3] = Math.max(most[i % 3], Math.abs(x))), most), [0, 0, 0]);
    const m = matrix(pose);
    return [[...pose.subarray(0, 3)], [0, 1, 2].map((i) => Math.abs(m[i]) * size[0] + Math.abs(m[i + 4]) * size[1] + Math.abs(m[i + 8]) * size[2])];
  };

  // Where the camera stands for some episodes, and how it follows them.
  const shot = (takes, surfaces) => {
    const nothing = () => [[1, 1, 1].map(() => Infinity), [1, 1, 1].map(() => -Infinity)];
    const join = ([low, high], at, half) => at.forEach((x, i) => {
      low[i] = Math.min(low[i], x - half[i]);
      high[i] = Math.max(high[i], x + half[i]);
    });
    const sides = ([low, high]) => low.map((x, i) => Math.max(high[i] - x, 0));
    const middle = ([low, high]) => low.map((x, i) => (x + high[i]) / 2);
    const all = nothing(), largest = [0, 0, 0], spread = [0, 0, 0, 0], mean = [0, 0, 0], seen = [];
    const paths = takes.map((take) => {
      let acting = take.solids.filter((solid) => !solid.fixed && !solid.ground);
      if (!acting.length) acting = take.solids.filter((solid) => !solid.ground);
      return take.times.map((_, k) => {
        const here = nothing();
        for (const solid of acting) {
          const [at, half] = bounds(solid, surfaces, k);
          if (!at.every(Number.isFinite)) continue;
          join(here, at, half);
          seen.push([at, half]);
          at.forEach((x, i) => (mean[i] += x));
        }
        for (const cord of take.cords) for (const part of cord.ways[Math.min(k, cord.ways.length - 1)]) for (const at of part) join(here, at, [0, 0, 0]);
        if (here[0][0] > here[1][0]) join(here, [0, 0, 0], [0.1, 0.1, 0.1]);
        join(all, here[0], [0, 0, 0]);
        join(all, here[1], [0, 0, 0]);
        sides(here).forEach((side, i) => (largest[i] = Math.max(largest[i], side)));
        return middle(here);
      });
    });
    // What moves along a line, or in an upright plane, is seen from the side.
    mean.forEach((x, i) => (mean[i] = x / (seen.length || 1)));
    for (const [at, half] of seen) {
      const [x, y, z] = add(at, mean, -1);
      [x * x + (half[0] * half[0]) / 3, x * y, y * y + (half[1] * half[1]) / 3, z * z + (half[2] * half[2]) / 3].forEach((part, i) => (spread[i] += part));
    }
    const [xx, xy, yy, zz] = spread;
    const root = Math.hypot((xx - yy) / 2, xy), most = (xx + yy) / 2 + root, least = (xx + yy) / 2 - root;
    const rise = zz < 0.1 * least ? 0.9 : 0.3;
    const turn = most > 2 * least ? Math.atan2(2 * xy, xx - yy) / 2 - Math.PI / 2 + 0.35 : -0.55;
    const size = Math.max(...largest, 1e-3);
    const follows = sides(all).map((side) => side > FOLLOWED * size);
    // What stands beside and is not much larger belongs to it.
    for (const take of takes) for (const solid of take.solids) {
      if (!solid.fixed || solid.ground) continue;
      const [at, half] = bounds(solid, surfaces, 0);
      const near = at.every((x, i) => x - half[i] < all[1][i] + size && x + half[i] > all[0][i] - size);
      if (near && Math.max(...half) <= size) join(all, at, half);
    }
    if (all[0][0] > all[1][0]) join(all, [0, 0, 0], [0.5, 0.5, 0.5]);
    const still = middle(all);
    const half = sides(all).map((side, i) => (follows[i] ? largest[i] : side / 2) || 1e-3);
    const centres = paths.map((path) => path.map((own, k) => {
      const near = path.slice(Math.max(k - SMOOTH, 0), k + SMOOTH + 1);
      return own.map((x, i) => {
        const smooth = near.reduce((sum, at) => sum + at[i], 0) / near.length;
        return follows[i] ? clamp(smooth, x - 0.3 * largest[i], x + 0.3 * largest[i]) : still[i];
      });
    }));
    return { turn, rise, half, still, centres, follows: follows.includes(true), radius: Math.hypot(...half) };
  };

  // What a viewer keeps on the graphics card. All of it is made again after the card was lost.
  const stage = (gl, scene) => {
    const program = (fragment) => {
      const made = gl.createProgram();
      for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, fragment]]) {
        const shader = gl.createShader(kind);
        gl.shaderSource(shader, text);
        gl.compileShader(shader);
        gl.attachShader(made, shader);
      }
      gl.linkProgram(made);
      if (!gl.getProgramParameter(made, gl.LINK_STATUS) && !gl.isContextLost()) {
        throw new Error(gl.getAttachedShaders(made).map((shader) => gl.getShaderInfoLog(shader)).join("") + gl.getProgramInfoLog(made));
      }
      const places = {};
      for (let i = gl.getProgramParameter(made, gl.ACTIVE_UNIFORMS) - 1; i >= 0; i--) {
        const { name } = gl.getActiveUniform(made, i);
        places[name] = gl.getUniformLocation(made, name);
      }
      return { made, places };
    };
    const buffer = (target, numbers) => {
      const made = gl.createBuffer();
      gl.bindBuffer(target, made);
      gl.bufferData(target, numbers, gl.STATIC_DRAW);
      return made;
    };
    const shape = ([points, faces]) => {
      const array = gl.createVertexArray();
      gl.bindVertexArray(array);
      const buffers = [buffer(gl.ARRAY_BUFFER, new Float32Array(points)), buffer(gl.ELEMENT_ARRAY_BUFFER, new Uint16Array(faces))];
      for (const [place, count, from] of [[0, 4, 0], [1, 3, 16]]) {
        gl.enableVertexAttribArray(place);
        gl.vertexAttribPointer(place, count, gl.FLOAT, false, 28, from);
      }
      return { array, buffers, count: faces.length };
    };
    const ball = shape(round_(28));
    const shapes = {
      ellipsoid: ball, capsule: ball, cord: shape(round_(8)), cylinder: shape(cylinder()), plane: shape(box([[2, 1]])),
      box: shape(box([[0, -1], [0, 1], [1, -1], [1, 1], [2, -1], [2, 1]])),
    };
    const map = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, map);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT24, SHADOW, SHADOW);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE);
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, gl.LINEAR);
    for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, name, gl.CLAMP_TO_EDGE);
    const frame = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, map, 0);
    gl.enable(gl.DEPTH_TEST);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    let surfaces = [];
    const made = {
      dark: program(DARK), paint: program(PAINT), shapes, map, frame,
      of: (solid) => surfaces[solid.surface] ?? shapes[solid.form],
      setScene: (scene) => {
        for (const { array, buffers } of surfaces) {
          gl.deleteVertexArray(array);
          buffers.forEach((one) => gl.deleteBuffer(one));
        }
        surfaces = scene.surfaces.map((one) => shape(surface(one)));
      },
    };
    made.setScene(scene);
    return made;
  };

  const make = (name, attributes = {}, ...inside) => {
    const made = document.createElement(name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.append(...inside);
    return made;
  };

  return (element, first, options = {}) => {
    const { autoplay = true, controls = true, sync } = options;
    // What viewers beside each other share. `zoom` and `pan` are relative to the picture that fits.
    const state = sync?.state ?? {
      take: 0, time: 0, playing: false, began: undefined, follow: true, members: new Set(),
      camera: undefined,
    };
    let scene = read(first), gpu, asked = 0, lost = false, seen = true, dead = false;
    const calm = matchMedia("(prefers-reduced-motion: reduce)");

    const canvas = make("canvas", { tabindex: 0, role: "application" });
    const takes = make("div", { class: "hw-row", role: "group", "aria-label": "Which episode" });
    const play = make("button", { type: "button", class: "hw-play" });
    const slider = make("input", { type: "range", min: 0, step: 0.01, "aria-label": "Time" });
    const clock = make("span", { class: "hw-clock" });
    const follow = make("button", { type: "button" }, "Follow");
    const reset = make("button", { type: "button" }, "Reset view");
    const about = make("p", { class: "hw-about" });
    const picture = make("div", { class: "hw-stage" }, canvas);
    const root = make("div", { class: "hw" }, ...(controls ? [takes] : []), picture,
      ...(controls ? [make("div", { class: "hw-row" }, play, make("label", {}, slider), clock, follow, reset)] : []), about);
    element.append(root);

    const gl = canvas.getContext("webgl2", { antialias: true });
    if (!gl) {
      picture.replaceChildren(make("p", { role: "status" },
        "This browser cannot draw in three dimensions: WebGL 2 is missing or turned off. A current Firefox, Chrome, Edge or Safari has it."));
    }

    const take = () => scene.takes[Math.min(state.take, scene.takes.length - 1)];
    const end = () => Math.max(...[...state.members].map((member) => member.end()), 0);
    const tell = () => state.members.forEach((member) => member.changed());
    const resetView = () => (state.camera = { turn: scene.shot.turn, rise: scene.shot.rise, zoom: 1, pan: [0, 0, 0] });
    if (!state.camera) resetView();

    // The moment before a time, and how far it is to the next.
    const when = () => {
      const { times } = take();
      let k = times.findIndex((time) => time > state.time) - 1;
      if (k < -1) k = times.length - 1;
      k = Math.max(k, 0);
      const next = Math.min(k + 1, times.length - 1);
      return [k, next, next > k ? clamp((state.time - times[k]) / (times[next] - times[k]), 0, 1) : 0];
    };
    const mix = (numbers, of, [k, next, share]) => {
      const [a, b] = [moment(numbers, of, k), moment(numbers, of, next)];
      // Quaternions of neighbours are near to each other: their mean, made a unit again, is the turn between them.
      const sign = of === 7 && a[3] * b[3] + a[4] * b[4] + a[5] * b[5] + a[6] * b[6] < 0 ? -1 : 1;
      const mixed = Array.from(a, (x, i) => x + share * ((i > 2 ? sign : 1) * b[i] - x));
      const norm = of === 7 ? Math.hypot(...mixed.slice(3)) : 1;
      return mixed.map((x, i) => (i > 2 ? x / norm : x));
    };
    const centre = (at) => {
      const path = scene.shot.centres[scene.takes.indexOf(take())];
      if (!path?.length || !state.follow) return scene.shot.follows && path?.length ? path[0] : scene.shot.still;
      return path[at[0]].map((x, i) => x + at[2] * (path[at[1]][i] - x));
    };

    // From the eye's distance at which the box just fits.
    const fitted = (aspect) => {
      const [right, up, back] = directions(scene.shot.turn, scene.shot.rise);
      const tan = Math.tan(LENS / 2);
      let distance = 0;
      for (let corner = 0; corner < 8; corner++) {
        const at = scene.shot.half.map((half, i) => (corner & (1 << i) ? half : -half));
        const needed = Math.max(Math.abs(dot(right, at)) / (tan * aspect), Math.abs(dot(up, at)) / tan) + dot(back, at);
        distance = Math.max(distance, needed);
      }
      return 1.08 * distance;
    };

    const draw = () => {
      const scale = Math.min(devicePixelRatio, 2);
      const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((side) => Math.max(Math.round(side * scale), 1));
      if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
      gpu ??= stage(gl, scene);
      const { shapes, dark, paint } = gpu;
      const at = when(), { solids, cords } = take(), { camera } = state, { radius } = scene.shot;
      const aspect = width / height;
      const distance = Math.max(...[...state.members].map((member) => member.fitted(aspect))) * camera.zoom;
      const axes = directions(camera.turn, camera.rise);
      const target = add(centre(at), camera.pan);
      const eye = add(target, axes[2], distance);
      const reach = 3 * distance + 4 * radius;
      const view = times(lens(aspect, distance / 50, distance + 1.5 * reach), seenFrom(eye, axes));
      const light = directions(scene.shot.turn + 0.8, 0.95);
      const wide = 1.6 * radius;
      const sun = times([1 / wide, 0, 0, 0, 0, 1 / wide, 0, 0, 0, 0, -1 / (2 * wide), 0, 0, 0, -1, 1], seenFrom(add(target, light[2], 2 * wide), light));

      // What is to be drawn, as it is now.
      const things = [];
      for (const solid of solids) {
        const pose = mix(solid.poses, 7, at);
        if (!pose.every(Number.isFinite)) continue;
        const m = matrix(pose), thing = { shape: gpu.of(solid), m, colour: [...solid.rgb, solid.opacity], shift: [0, 0, 0], stretch: 0, ground: solid.ground, squares: solid.ground ? round(radius / 2) : 0 };
        let size = mix(solid.sizes, 3, at);
        if (solid.form === "plane") {
          const [x, y, z] = [0, 4, 8].map((i) => dot(add(target, pose, -1), m.slice(i, i + 3)));
          // Nothing is seen of a plane from below.
          if (dot(add(eye, pose, -1), m.slice(8, 11)) < 0) continue;
          const most = 1.2 * reach;
          thing.shift = [0, 0, -1];
          size = [x, y].map((middle, i) => {
            const edge = size[i] > 0 ? size[i] : Infinity;
            const [low, high] = [Math.max(middle - most, -edge), Math.min(middle + most, edge)];
            thing.shift[i] = (low + high) / 2;
            return Math.max((high - low) / 2, 0);
          });
          size.push(1);
        } else if (solid.form === "capsule") {
          thing.stretch = size[2];
          size[2] = size[0];
        }
        thing.size = size.map((side) => Math.max(side, 1e-7));
        things.push(thing);
      }
      // Cords are as wide on the screen wherever they are.
      const thick = (1.4 * scale * distance * Math.tan(LENS / 2) * 2) / height;
      for (const { rgb, ways } of cords) {
        const [now, next] = [ways[Math.min(at[0], ways.length - 1)], ways[Math.min(at[1], ways.length - 1)]];
        now.forEach((part, i) => {
          const other = next[i]?.length === part.length ? next[i] : part;
          const points = part.map((from, j) => add(from, add(other[j], from, -1), at[2]));
          for (let j = 1; j < points.length; j++) {
            const stretch = Math.hypot(...add(points[j], points[j - 1], -1)) / 2;
            things.push({ shape: shapes.cord, m: along(points[j - 1], points[j]), size: [thick, thick, thick], stretch, shift: [0, 0, 0], colour: [...rgb, 1], squares: 0 });
          }
        });
      }

      const show = ({ places }, some) => {
        for (const thing of some) {
          gl.uniformMatrix4fv(places.pose, false, thing.m);
          gl.uniform3fv(places.size, thing.size);
          gl.uniform3fv(places.shift, thing.shift);
          gl.uniform1f(places.stretch, thing.stretch);
          if (places.colour) {
            gl.uniform4fv(places.colour, thing.colour);
            gl.uniform1f(places.squares, thing.squares);
          }
          gl.bindVertexArray(thing.shape.array);
          gl.drawElements(gl.TRIANGLES, thing.shape.count, gl.UNSIGNED_SHORT, 0);
        }
      };
      const clear = (thing) => thing.colour[3] < 1;
      const far = (thing) => -Math.hypot(...add(thing.m.slice(12, 15), eye, -1));
      const solid = things.filter((thing) => !thing.ground && !clear(thing));
      gl.depthMask(true);
      gl.disable(gl.BLEND);
      gl.bindFramebuffer(gl.FRAMEBUFFER, gpu.frame);
      gl.viewport(0, 0, SHADOW, SHADOW);
      gl.clear(gl.DEPTH_BUFFER_BIT);
      gl.useProgram(dark.made);
      gl.uniformMatrix4fv(dark.places.view, false, sun);
      gl.enable(gl.POLYGON_OFFSET_FILL);
      gl.polygonOffset(1.5, 2);
      show(dark, solid);
      gl.disable(gl.POLYGON_OFFSET_FILL);
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
      gl.viewport(0, 0, width, height);
      gl.clearColor(0, 0, 0, 0);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      gl.useProgram(paint.made);
      gl.bindTexture(gl.TEXTURE_2D, gpu.map);
      gl.uniformMatrix4fv(paint.places.view, false, view);
      gl.uniformMatrix4fv(paint.places.sun, false, sun);
      gl.uniform3fv(paint.places.eye, eye);
      gl.uniform3fv(paint.places.target, target);
      gl.uniform3fv(paint.places.towards, light[2]);
      gl.uniform1f(paint.places.reach, reach);
      show(paint, solid);
      gl.enable(gl.BLEND);
      show(paint, things.filter((thing) => thing.ground));
      // What is seen through comes last, from the back.
      gl.depthMask(false);
      gl.enable(gl.CULL_FACE);
      show(paint, things.filter((thing) => !thing.ground && clear(thing)).sort((a, b) => far(a) - far(b)));
      gl.disable(gl.CULL_FACE);
    };

    const told = () => {
      const { told, worth } = take(), [k, , share] = when(), i = share > 0.5 ? Math.min(k + 1, told.length - 1) : k;
      return `${Math.min(state.time, take().end).toFixed(2)} s, ${told[i] || `return ${words(worth[i])}`}`;
    };
    const refresh = () => {
      slider.value = state.time;
      clock.textContent = told();
      slider.setAttribute("aria-valuetext", clock.textContent);
    };
    // Buttons and texts, after the scene or the episode is another one.
    const build = () => {
      canvas.setAttribute("aria-label", `${options.label ?? scene.title}: a picture in three dimensions. Arrows turn it, plus and minus zoom, Home resets it, space plays and stops.`);
      if (takes.childElementCount !== scene.takes.length || takes.scene !== scene) {
        takes.scene = scene;
        takes.replaceChildren(...scene.takes.map((one, i) => {
          const button = make("button", { type: "button" }, one.name || `episode ${one.index}`);
          if (one.success !== undefined) button.append(" ", make("span", { class: one.success ? "hw-good" : "hw-bad" }, one.success ? "success" : "failure"));
          button.addEventListener("click", () => viewer.choose(i));
          return button;
        }));
      }
      takes.hidden = scene.takes.length < 2;
      [...takes.children].forEach((button, i) => button.setAttribute("aria-pressed", String(scene.takes[i] === take())));
      const one = take(), flat = one?.solids.some((solid) => solid.ground);
      about.textContent = one ? [
        `episode ${one.index}${one.success === undefined ? "" : one.success ? ": success" : ": failure"}`, one.kind, one.about,
        `return ${words(one.return)} (discounted ${words(one.discounted_return)})`, `${one.steps} steps`,
        flat && `squares on the ground have edges of ${length(round(scene.shot.radius / 2))}`].filter(Boolean).join(", ") + "." : "No episode is here.";
      follow.hidden = !scene.shot.follows;
    };
    const changed = () => {
      if (dead || !take()) return;
      slider.max = end();
      play.textContent = state.playing ? "Stop" : "Play";
      follow.setAttribute("aria-pressed", String(state.follow));
      refresh();
      if (!asked) asked = requestAnimationFrame(tick);
    };
    const tick = (now) => {
      asked = 0;
      if (dead) return;
      if (state.playing) {
        state.began ??= now - 1000 * state.time;
        if (now - state.began > 1000 * (end() + REST)) state.began = now;
        state.time = clamp((now - state.began) / 1000, 0, end());
        refresh();
        asked = requestAnimationFrame(tick);
      }
      if (gl && !lost && seen) {
        draw();
        viewer.onframe?.(state.time, state.take);
      }
    };

    const viewer = {
      state,
      onframe: undefined,
      setScene: (next) => {
        scene = read(next);
        state.take = clamp(state.take, 0, Math.max(scene.takes.length - 1, 0));
        gpu?.setScene(scene);
        state.time = Math.min(state.time, end());
        state.members.forEach((member) => member.build());
        tell();
      },
      choose: (index) => {
        state.take = clamp(index, 0, Math.max(scene.takes.length - 1, 0));
        state.time = 0;
        state.began = undefined;
        state.members.forEach((member) => member.build());
        tell();
      },
      seek: (seconds) => {
        state.time = clamp(seconds, 0, end());
        state.began = undefined;
        tell();
      },
      play: () => {
        if (state.time >= end()) state.time = 0;
        Object.assign(state, { playing: true, began: undefined });
        tell();
      },
      stop: () => {
        state.playing = false;
        tell();
      },
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
    const member = { changed, build, fitted, end: () => take()?.end ?? 0 };
    state.members.add(member);

    // Camera: one finger or the left button turns; two fingers or the right button move; wheel and pinch zoom.
    const pointers = new Map();
    const zoom = (by) => (state.camera.zoom = clamp(state.camera.zoom * by, 0.05, 20));
    const turn = (across, up) => {
      state.camera.turn -= across;
      state.camera.rise = clamp(state.camera.rise + up, -1.5, 1.55);
    };
    const pan = (x, y) => {
      const [right, up] = directions(state.camera.turn, state.camera.rise);
      const metres = (2 * Math.tan(LENS / 2) * fitted(canvas.clientWidth / canvas.clientHeight) * state.camera.zoom) / canvas.clientHeight;
      state.camera.pan = add(add(state.camera.pan, right, -x * metres), up, y * metres);
    };
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      canvas.focus({ preventScroll: true });
      pointers.set(event.pointerId, [event.clientX, event.clientY]);
    });
    canvas.addEventListener("pointermove", (event) => {
      const before = pointers.get(event.pointerId);
      if (!before) return;
      const now = [event.clientX, event.clientY], [x, y] = [now[0] - before[0], now[1] - before[1]];
      pointers.set(event.pointerId, now);
      if (pointers.size === 2) {
        const other = [...pointers].find(([id]) => id !== event.pointerId)[1];
        const apart = (at) => Math.hypot(at[0] - other[0], at[1] - other[1]) || 1;
        zoom(apart(before) / apart(now));
        pan(x / 2, y / 2);
      } else if (event.buttons & 6 || event.shiftKey) pan(x, y);
      else turn(x * 0.008, y * 0.008);
      tell();
    });
    for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, (event) => pointers.delete(event.pointerId));
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => {
      // The wheel scrolls a long page until the picture is clicked.
      if (document.activeElement !== canvas && document.documentElement.scrollHeight > innerHeight) return;
      event.preventDefault();
      zoom(Math.exp(event.deltaY * (event.deltaMode ? 0.03 : 0.001)));
      tell();
    }, { passive: false });
    canvas.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) return;
      const does = {
        ArrowLeft: () => turn(-0.1, 0), ArrowRight: () => turn(0.1, 0), ArrowUp: () => turn(0, 0.1), ArrowDown: () => turn(0, -0.1),
        "+": () => zoom(0.9), "=": () => zoom(0.9), "-": () => zoom(1 / 0.9), Home: resetView, " ": toggle,
      }[event.key];
      if (!does) return;
      event.preventDefault();
      does();
      tell();
    });
    const toggle = () => (state.playing ? viewer.stop() : viewer.play());
    play.addEventListener("click", toggle);
    slider.addEventListener("input", () => {
      state.playing = false;
      viewer.seek(Number(slider.value));
    });
    slider.addEventListener("keydown", (event) => {
      if (event.key !== " ") return;
      event.preventDefault();
      toggle();
    });
    reset.addEventListener("click", () => {
      resetView();
      tell();
    });
    follow.addEventListener("click", () => {
      state.follow = !state.follow;
      tell();
    });
    canvas.addEventListener("webglcontextlost", (event) => {
      event.preventDefault();
      lost = true;
    });
    canvas.addEventListener("webglcontextrestored", () => {
      lost = false;
      gpu = undefined;
      changed();
    });
    calm.addEventListener("change", viewer.stop);
    const sized = new ResizeObserver(changed);
    sized.observe(picture);
    const watched = new IntersectionObserver((entries) => {
      seen = entries.at(-1).isIntersecting;
      if (seen) changed();
    });
    watched.observe(picture);
    if (options.take !== undefined) state.take = options.take;
    build();
    if (autoplay && !calm.matches && !sync) viewer.play();
    else tell();
    return viewer;
  };
})();
