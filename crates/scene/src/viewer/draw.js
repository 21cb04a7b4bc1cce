// A picture.

// Solids as they are at a moment: shape, pose, size and colour.
const solidsAt = (gpu, { solids, shot, at, target, eye, reach, floor }) => {
  const things = [];
  for (const solid of solids) {
    const place = between(solid.poses, 7, at), pose = matrix(place);
    let [size, stretch, shift] = [between(solid.sizes, 3, at), 0, [0, 0, 0]];
    if (!place.every(Number.isFinite)) continue;
    if (solid.form === "plane") {
      // Nothing is seen of a plane from below.
      if (dot(add(eye, place, -1), pose.slice(8, 11)) < 0) continue;
      // As much of it as the eye reaches.
      const ends = [0, 1].map((i) => {
        const middle = dot(add(target, place, -1), pose.slice(4 * i, 4 * i + 3)), edge = size[i] || Infinity;
        return [Math.max(middle - reach, -edge), Math.min(middle + reach, edge)];
      });
      if (ends.some(([low, high]) => low >= high)) continue;
      size = [...ends.map(([low, high]) => (high - low) / 2), 1];
      shift = [...ends.map(([low, high]) => (high + low) / 2), -1];
    } else if (solid.form === "capsule") {
      stretch = size[2];
      size[2] = size[0];
    }
    const rgb = solid.ground ? solid.rgb.map((part, i) => 0.4 * part + 0.6 * floor[i]) : solid.rgb;
    things.push({
      shape: gpu.of(solid), pose, size: size.map((side) => Math.max(side, 1e-7)), shift, stretch, colour: [...rgb, solid.opacity],
      ground: solid.ground, squares: solid.ground ? squares(shot) : 0,
    });
  }
  return things;
};

// Cords, piece by piece.
const cordsAt = (gpu, { cords, at }, radius) => {
  const things = [];
  for (const { rgb, ways } of cords) {
    const [now, next] = [0, 1].map((i) => ways[Math.min(at[i], ways.length - 1)]);
    now.forEach((part, i) => {
      const other = next[i]?.length === part.length ? next[i] : part;
      const points = part.map((from, j) => add(from, add(other[j], from, -1), at[2]));
      for (let j = 1; j < points.length; j++) {
        const stretch = Math.hypot(...add(points[j], points[j - 1], -1)) / 2;
        things.push({
          shape: gpu.shapes.cord, pose: along(points[j - 1], points[j]), size: [radius, radius, radius], shift: [0, 0, 0], stretch,
          colour: [...rgb, 1], squares: 0,
        });
      }
    });
  }
  return things;
};

// What is to be seen: `solids` and `cords` at the moment `at`; the camera's `turn` and `rise`, its `target` and its `distance` from
// there; `size`, pixels; how many of them are one of the page (`scale`); the colour of ground (`floor`).
const draw = (gl, gpu, picture) => {
  const { shot, turn, rise, target, distance, size: [width, height], scale } = picture;
  const axes = directions(turn, rise), eye = add(target, axes[2], distance);
  const reach = 3 * distance + 4 * shot.radius;
  const view = times(lens(width / height, distance / 50, distance + 2 * reach), seenFrom(eye, axes));
  const light = directions(shot.turn + 0.8, 0.95), wide = 1.6 * shot.radius;
  const box = [1 / wide, 0, 0, 0, 0, 1 / wide, 0, 0, 0, 0, -0.5 / wide, 0, 0, 0, -1, 1];
  const sun = times(box, seenFrom(add(target, light[2], 2 * wide), light));

  // Cords are as wide on the screen wherever they are.
  const thick = (2.8 * scale * distance * Math.tan(LENS / 2)) / height;
  const things = [...solidsAt(gpu, { ...picture, eye, reach }), ...cordsAt(gpu, picture, thick)];
  const clear = (thing) => !thing.ground && thing.colour[3] < 1;
  const far = (thing) => Math.hypot(...add(thing.pose.slice(12, 15), eye, -1));
  const solid = things.filter((thing) => !thing.ground && !clear(thing));
  const show = (places, some) => {
    for (const { shape, pose, size, shift, stretch, colour, squares } of some) {
      gl.uniformMatrix4fv(places.pose, false, pose);
      gl.uniform3fv(places.size, size);
      gl.uniform3fv(places.shift, shift);
      gl.uniform1f(places.stretch, stretch);
      gl.uniform4fv(places.colour ?? null, colour);
      gl.uniform1f(places.squares ?? null, squares);
      gl.bindVertexArray(shape.array);
      gl.drawElements(gl.TRIANGLES, shape.count, gl.UNSIGNED_SHORT, 0);
    }
  };

  // What the sun sees is in its light.
  gl.depthMask(true);
  gl.disable(gl.BLEND);
  gl.bindFramebuffer(gl.FRAMEBUFFER, gpu.frame);
  gl.viewport(0, 0, SHADOW, SHADOW);
  gl.clear(gl.DEPTH_BUFFER_BIT);
  gl.useProgram(gpu.dark.made);
  gl.uniformMatrix4fv(gpu.dark.places.view, false, sun);
  gl.enable(gl.POLYGON_OFFSET_FILL);
  gl.polygonOffset(1.5, 2);
  show(gpu.dark.places, solid);
  gl.disable(gl.POLYGON_OFFSET_FILL);

  const { made, places } = gpu.paint;
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.viewport(0, 0, width, height);
  gl.clearColor(0, 0, 0, 0);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  gl.useProgram(made);
  gl.bindTexture(gl.TEXTURE_2D, gpu.map);
  gl.uniformMatrix4fv(places.view, false, view);
  gl.uniformMatrix4fv(places.sun, false, sun);
  gl.uniform3fv(places.eye, eye);
  gl.uniform3fv(places.target, target);
  gl.uniform3fv(places.towards, light[2]);
  gl.uniform1f(places.reach, reach);
  show(places, solid);
  gl.enable(gl.BLEND);
  show(places, things.filter((thing) => thing.ground));
  // What is seen through comes last, from the back.
  gl.depthMask(false);
  gl.enable(gl.CULL_FACE);
  show(places, things.filter(clear).sort((a, b) => far(b) - far(a)));
  gl.disable(gl.CULL_FACE);
};
