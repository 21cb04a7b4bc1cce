// Where the camera stands.

const SMOOTH = 4; // moments over which the way of the camera is smoothed, to either side
const FOLLOWED = 3; // what goes so many times its own size is followed

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

// How far from the middle the eye sees all of a box.
const fitting = ({ turn, rise, half }, aspect) => {
  const [right, up, back] = directions(turn, rise), tan = Math.tan(LENS / 2);
  const corners = [...Array(8).keys()].map((corner) => half.map((side, i) => (corner & (1 << i) ? side : -side)));
  return 1.08 * Math.max(...corners.map((at) => Math.max(Math.abs(dot(right, at)) / aspect, Math.abs(dot(up, at))) / tan + dot(back, at)));
};
