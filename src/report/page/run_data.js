// What viewer_data.h packs: arrays as zlib streams in base64, positions and fields as 16-bit fractions of a range.

const kinds = { uint8: Uint8Array, uint16: Uint16Array, uint32: Uint32Array };
const none = 65535; // a field's value that is not a number

async function bytesOf(text) {
  const binary = atob(text),
    packed = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; ++i) packed[i] = binary.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Response(stream).arrayBuffer();
}

/** The typed array that {type, data} packs. */
export const unpack = async ({ type, data }) => new kinds[type](await bytesOf(data));
export const unpackText = async (data) => new TextDecoder().decode(await bytesOf(data));

/** Frames are stored as differences modulo 2^16 to the frame before; this undoes it. */
function addUp(values, count) {
  for (let i = count; i < values.length; ++i) values[i] += values[i - count];
  return values;
}

export class RunData {
  static async read(viewer) {
    const { triangles, positions, fields, ...plain } = viewer;
    const run = Object.assign(new RunData(), plain);
    run.corners = await unpack(triangles);
    run.triangleCount = run.corners.length / 3;
    run.quantized = addUp(await unpack(positions), 3 * run.vertices);
    run.fields = [];
    for (const field of fields) {
      run.fields.push({ ...field, values: addUp(await unpack(field.values), run.triangleCount) });
    }
    return run;
  }

  /** Coordinates of the vertices in a frame, m. */
  positions(frame) {
    const { low, high } = this.box,
      start = frame * 3 * this.vertices,
      at = new Float32Array(3 * this.vertices);
    for (let i = 0; i < at.length; ++i) {
      const axis = i % 3;
      at[i] = low[axis] + ((high[axis] - low[axis]) * this.quantized[start + i]) / 65535;
    }
    return at;
  }

  /** The value of a triangle, NaN where there is none. */
  value(field, frame, triangle) {
    const stored = field.values[frame * this.triangleCount + triangle];
    return stored === none ? NaN : field.least + ((field.most - field.least) * stored) / (none - 1);
  }

  layerOf(triangle) {
    return this.layers.findIndex(({ first, count }) => triangle >= first && triangle < first + count);
  }

  triangleName(triangle) {
    const layer = this.layers[this.layerOf(triangle)];
    return `triangle ${triangle - layer.offset} of ${layer.body}`;
  }
}
