// Vectors and matrices; numbers as words.

// Matrices are 4 × 4, column by column.
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
const LENS = 0.6; // angle of the picture from top to bottom, rad
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
// The edge of the squares on the ground.
const squares = ({ radius }) => round(radius / 2);
const clamp = (x, low, high) => Math.min(Math.max(x, low), high);
const words = (x) => (Number.isFinite(x) ? x.toFixed(clamp(2 - Math.floor(Math.log10(Math.abs(x) || 1)), 0, 4)) : "not finite");
const length = (m) => (m < 1 ? `${+(1000 * m).toPrecision(3)} mm` : `${+m.toPrecision(3)} m`);
