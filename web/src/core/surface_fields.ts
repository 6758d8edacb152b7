/** Fields of the segmentation's surfaces, beside those of the simulation: their names in a list, and beside a value. */
export const kSurfaceFields = [
  { key: "confidence", label: "confidence of the segmentation", short: "confidence", unit: "" },
  { key: "uncertainty_mm", label: "95 % interval of the surface, ±", short: "surface ±", unit: "mm" },
  { key: "cartilage_thickness_mm", label: "cartilage thickness over the bone", short: "cartilage thickness", unit: "mm" },
];
