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
  const ball = shape(rounded(28));
  const shapes = {
    ellipsoid: ball, capsule: ball, cord: shape(rounded(8)), cylinder: shape(cylinder()), plane: shape(box([[2, 1]])),
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
