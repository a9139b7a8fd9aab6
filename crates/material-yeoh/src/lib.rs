//! Yeoh hyperelasticity: energy, stress, tangent.
