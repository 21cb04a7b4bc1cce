// Scenes as they come from JSON.

const decode = (text, Kind) => {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Kind(bytes.buffer);
};

// As light: screens show about the square of what they are told.
const linear = (colour) => colour.map((part) => (part / 255) ** 2);

// A scene with its numbers read, and where things are.
const read = (scene) => {
  const surfaces = scene.surfaces.map((one) => {
    const points = decode(one.points, Float32Array), half = [0, 0, 0];
    points.forEach((part, i) => (half[i % 3] = Math.max(half[i % 3], Math.abs(part))));
    return { points, half, faces: decode(one.faces, Uint16Array) };
  });
  const takes = scene.takes.map((take) => ({
    ...take,
    end: take.times.at(-1) ?? 0,
    solids: take.solids.map((solid) => ({
      ...solid,
      ground: solid.form === "plane" || solid.form === "field",
      rgb: linear(solid.colour),
      poses: decode(solid.poses, Float32Array),
      sizes: decode(solid.sizes, Float32Array),
    })),
    cords: take.cords.map((cord) => ({ rgb: linear(cord.colour), ways: ways(decode(cord.ways, Float32Array)) })),
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
  if (solid.form === "mesh") size = surfaces[solid.surface].half;
  const m = matrix(pose);
  return [[...pose.subarray(0, 3)], [0, 1, 2].map((i) => Math.abs(m[i]) * size[0] + Math.abs(m[i + 4]) * size[1] + Math.abs(m[i + 8]) * size[2])];
};

// The moment before a time, the one after it, and how far it is to that one.
const when = (times, seconds) => {
  const after = times.findIndex((time) => time > seconds);
  const k = Math.max(after < 0 ? times.length - 1 : after - 1, 0);
  const next = Math.min(k + 1, times.length - 1);
  return [k, next, next > k ? clamp((seconds - times[k]) / (times[next] - times[k]), 0, 1) : 0];
};
// Numbers between two moments.
const between = (numbers, of, [k, next, share]) => {
  const [a, b] = [moment(numbers, of, k), moment(numbers, of, next)];
  // Quaternions of neighbours are near to each other: what is between them, made a unit again, is the turn between them.
  const turned = of === 7 && dot(a.subarray(3), b.subarray(3)) + a[6] * b[6] < 0 ? -1 : 1;
  const mixed = Array.from(a, (x, i) => x + share * ((i > 2 ? turned : 1) * b[i] - x));
  const norm = of === 7 ? Math.hypot(...mixed.slice(3)) : 1;
  return mixed.map((x, i) => (i > 2 ? x / norm : x));
};
