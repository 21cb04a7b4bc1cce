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
const rounded = (sides) => {
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
  const normals = [], around = Array.from({ length: points.length / 3 }, () => []), out = [];
  for (let f = 0; f < faces.length; f += 3) {
    const [a, b, c] = [at(faces[f]), at(faces[f + 1]), at(faces[f + 2])];
    normals.push(cross(add(b, a, -1), add(c, a, -1)));
    for (let k = 0; k < 3; k++) around[faces[f + k]].push(f / 3);
  }
  const units = normals.map(unit);
  faces.forEach((point, i) => {
    const own = units[Math.floor(i / 3)];
    const near = around[point].filter((f) => dot(units[f], own) > 0.7);
    out.push(...at(point), 0, ...unit(near.reduce((sum, f) => add(sum, normals[f]), [0, 0, 0])));
  });
  return [out, [...faces.keys()]];
};
