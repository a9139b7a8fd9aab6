// How surfaces and lines are drawn. Varyings are taken inside of the triangles (`centroid`): beyond their edges, where smoothed edges ask for
// them, those of slivers are anything, and would leave dots of what is cut away. Values are interpolated before they become colours, so that colours between nodes are those
// of the map; what lies beyond the section plane (in reference coordinates) is left out.

import { DataTexture, DoubleSide, FrontSide, LinearFilter, ShaderMaterial, Vector4 } from "three";
import { colourBytes } from "pneuflex/colours";

const PASS_REFERENCE = /* glsl */ `
  attribute vec3 reference;
  centroid varying vec3 vReference;
`;

const CUT = /* glsl */ `
  uniform vec4 plane;
  uniform float slack;
  centroid varying vec3 vReference;
  // About a pixel further than the plane, so that no light shines between the surface and the cut face.
  bool beyond() {
    float distance = dot(vReference, plane.xyz) - plane.w;
    return distance > min(fwidth(distance), slack);
  }
`;

/** A plane that cuts nothing. */
export const NO_PLANE = [0, 0, 0, 1];

/** What all surfaces share: the colour map and its range, and how far, in mm, they may reach beyond the section plane. */
export function colourUniforms(slack) {
  const texture = new DataTexture(new Uint8Array(4 * 256), 256, 1);
  texture.magFilter = texture.minFilter = LinearFilter;
  return { map: { value: texture }, low: { value: 0 }, top: { value: 1 }, glass: { value: false }, slack: { value: slack } };
}

/** Chooses a colour map. */
export function useMap(uniforms, map) {
  uniforms.map.value.image.data.set(colourBytes(map));
  uniforms.map.value.needsUpdate = true;
}

/**
 * A lit, coloured surface. `plain` surfaces (cut faces where the field means nothing) are grey; with `glass`, surfaces are
 * translucent where the value is zero.
 */
export function surfaceMaterial(colours, isCap) {
  return new ShaderMaterial({
    uniforms: { ...colours, plane: { value: new Vector4(...NO_PLANE) }, plain: { value: false }, sign: { value: 1 } },
    vertexShader: /* glsl */ `
      ${PASS_REFERENCE}
      attribute float value;
      centroid varying float vValue;
      centroid varying vec3 vNormal;
      centroid varying vec3 vView;
      void main() {
        vReference = reference;
        vValue = value;
        vNormal = normalMatrix * normal;
        vec4 view = modelViewMatrix * vec4(position, 1.0);
        vView = view.xyz;
        gl_Position = projectionMatrix * view;
      }`,
    fragmentShader: /* glsl */ `
      ${CUT}
      uniform sampler2D map;
      uniform float low;
      uniform float top;
      uniform float sign;
      uniform bool plain;
      uniform bool glass;
      centroid varying float vValue;
      centroid varying vec3 vNormal;
      centroid varying vec3 vView;
      void main() {
        if (beyond()) discard;
        float share = clamp((sign * vValue - low) / (top - low), 0.0, 1.0);
        vec3 colour = plain ? vec3(0.78) : texture2D(map, vec2((share * 255.0 + 0.5) / 256.0, 0.5)).rgb;
        vec3 n = normalize(vNormal) * (gl_FrontFacing ? 1.0 : -1.0);
        vec3 light = normalize(vec3(-0.35, 0.65, 0.7));
        vec3 toEye = normalize(-vView);
        float diffuse = 0.5 + 0.5 * dot(n, light);
        float shine = pow(max(dot(n, normalize(light + toEye)), 0.0), 48.0);
        float shade = mix(0.58, 1.04, diffuse * diffuse * (3.0 - 2.0 * diffuse));
        float opacity = glass && !plain ? mix(0.2, 1.0, smoothstep(0.0, 0.04, share)) : 1.0;
        gl_FragColor = vec4(colour * shade + 0.07 * shine, opacity);
      }`,
    side: isCap ? DoubleSide : FrontSide,
    // Lines on the surface stay in front of it.
    polygonOffset: true,
    polygonOffsetFactor: 1,
    polygonOffsetUnits: 1,
  });
}

/** A lit, translucent surface: denser where it is seen at a glancing angle, unless it is flat; what is hollow is seen through. */
export function obstacleMaterial(isFlat, isHollow) {
  return new ShaderMaterial({
    uniforms: { colour: { value: [0, 0, 0] }, opacity: { value: isHollow ? 0.16 : isFlat ? 0.34 : 0.42 }, rim: { value: isFlat ? 0 : 0.35 }, hollow: { value: isHollow } },
    vertexShader: /* glsl */ `
      centroid varying vec3 vNormal;
      centroid varying vec3 vView;
      void main() {
        vNormal = normalMatrix * normal;
        vec4 view = modelViewMatrix * vec4(position, 1.0);
        vView = view.xyz;
        gl_Position = projectionMatrix * view;
      }`,
    fragmentShader: /* glsl */ `
      uniform vec3 colour;
      uniform float opacity;
      uniform float rim;
      uniform bool hollow;
      centroid varying vec3 vNormal;
      centroid varying vec3 vView;
      void main() {
        vec3 n = normalize(vNormal) * (gl_FrontFacing ? 1.0 : -1.0);
        vec3 toEye = normalize(-vView);
        float diffuse = 0.5 + 0.5 * dot(n, normalize(vec3(-0.35, 0.65, 0.7)));
        float glance = 1.0 - abs(dot(n, toEye));
        float density = opacity + rim * glance * glance * glance;
        // The nearer wall of what is hollow hides the body.
        if (hollow && gl_FrontFacing) density *= 0.45;
        gl_FragColor = vec4(colour * mix(0.62, 1.08, diffuse), density);
      }`,
    transparent: true,
    depthWrite: false,
    side: isFlat || isHollow ? DoubleSide : FrontSide,
    // What is far is drawn before what is near.
    forceSinglePass: false,
  });
}

/** Lines, or with `filled` an unlit transparent surface. */
export function flatMaterial(opacity, filled = false) {
  return new ShaderMaterial({
    uniforms: { plane: { value: new Vector4(...NO_PLANE) }, slack: { value: 0 }, colour: { value: [0, 0, 0] }, opacity: { value: opacity } },
    vertexShader: /* glsl */ `
      ${PASS_REFERENCE}
      void main() {
        vReference = reference;
        gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
      }`,
    fragmentShader: /* glsl */ `
      ${CUT}
      uniform vec3 colour;
      uniform float opacity;
      void main() {
        if (beyond()) discard;
        gl_FragColor = vec4(colour, opacity);
      }`,
    transparent: true,
    depthWrite: false,
    side: filled ? DoubleSide : FrontSide,
  });
}
