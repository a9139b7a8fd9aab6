// The modelled part and its mirror images at planes of symmetry through the origin. An image is the signs, by axis, with which the
// part's coordinates become its own.

import { FIELDS } from "pneuflex/legend";

/** All images, the part itself first; `mirrored` says by axis whether there is a plane normal to it. */
export function imagesOf(mirrored) {
  let images = [[1, 1, 1]];
  mirrored.forEach((isCut, axis) => {
    if (isCut) images = [...images, ...images.map((signs) => signs.with(axis, -1))];
  });
  return images;
}

/** A place relative to the origin, or a displacement, of the part as it is on an image. */
export const onImage = (signs, vector) => vector.map((x, axis) => signs[axis] * x);

/** The sign that a field's values have there. */
export const signOf = (field, signs) => (FIELDS[field].odd ?? []).reduce((sign, axis) => sign * signs[axis], 1);

/** Whether some image has a field's values with the opposite sign. */
export const isOdd = (field, mirrored) => (FIELDS[field].odd ?? []).some((axis) => mirrored[axis]);
