// Colour scales of the viewer.

// "magma" of matplotlib (CC0), light to dark, as in the SVG pictures: even to the eye and readable without colour vision.
const magma = [
  [252, 253, 191],
  [254, 201, 141],
  [253, 149, 103],
  [241, 96, 93],
  [205, 64, 113],
  [159, 47, 127],
  [114, 31, 129],
  [69, 16, 119],
];
const categories = [
  [106, 172, 196],
  [226, 152, 92],
  [146, 190, 110],
  [186, 140, 200],
  [214, 198, 96],
  [150, 150, 160],
];
export const missing = [150, 150, 150];

export const category = (index) => categories[index % categories.length];

/** The colour at a fraction of the scale. */
export function scaleColour(fraction) {
  const place = Math.min(Math.max(fraction, 0), 1) * (magma.length - 1),
    below = Math.min(Math.floor(place), magma.length - 2);
  return magma[below].map((value, i) => value + (place - below) * (magma[below + 1][i] - value));
}

export const css = (rgb) => `rgb(${rgb.map(Math.round).join(' ')})`;
export const gradient = `linear-gradient(to top, ${magma.map(css).join(', ')})`;
