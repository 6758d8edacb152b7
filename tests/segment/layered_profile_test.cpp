#include <coxa/core/error.h>
#include <coxa/core/rng.h>
#include <coxa/segment/layered_profile.h>

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace coxa::segment {
namespace {

/// Brightness from an edge outwards.
struct Layer {
  double from = 0.0, brightness = 0.0;
};

/// Layers blurred by summing a finely sampled Gaussian, not by the model's error functions.
VecX blurred_layers(const std::vector<Layer>& layers, double blur) {
  const ProfileGrid grid;
  VecX profile(grid.n);
  constexpr double kFine = 0.02;
  for (Index i = 0; i < grid.n; ++i) {
    double sum = 0.0, total = 0.0;
    for (double offset = -5.0 * blur; offset <= 5.0 * blur; offset += kFine) {
      const double weight = std::exp(-0.5 * std::pow(offset / blur, 2));
      double value = 0.0;
      for (const Layer& layer : layers) {
        if (grid.at(i) + offset >= layer.from) value = layer.brightness;
      }
      sum += weight * value;
      total += weight;
    }
    profile[i] = sum / total;
  }
  return profile;
}

const TissueBrightness kT1{190.0, 20.0, 95.0, 6.0, 8.0};
const TissueBrightness kDess{65.0, 20.0, 300.0, 18.0, 15.0};

VecX covered(const TissueBrightness& b, double bone, double cortex, double thickness,
             double beyond) {
  return blurred_layers({{-100.0, b.marrow},
                         {bone - cortex, b.cortex},
                         {bone, b.cartilage},
                         {bone + thickness, beyond}},
                        0.4);
}

}  // namespace

TEST(LayerModel, FindsBorderAndThicknessInT1AndDess) {
  for (const TissueBrightness& b : {kT1, kDess}) {
    const LayerModel model(b, 0.4);
    for (const double bone : {-0.9, -0.2, 0.45}) {
      for (const double thickness : {1.0, 1.7, 3.1}) {
        for (const double cortex : {0.6, 1.4}) {
          const LayerFit fit = model.fit(covered(b, bone, cortex, thickness, 40.0));
          EXPECT_GT(fit.evidence, 1.0) << bone << " " << thickness << " " << cortex;
          EXPECT_NEAR(fit.bone, bone, 0.2) << thickness << " " << cortex;
          EXPECT_NEAR(fit.thickness, thickness, 0.35) << bone << " " << cortex;
        }
      }
    }
  }
}

TEST(LayerModel, TakesAThinLayerBetweenBonesForTheSumOfBoth) {
  const LayerModel model(kT1, 0.4);
  const LayerFit fit = model.fit(covered(kT1, 0.0, 1.0, 3.6, kT1.cortex));
  EXPECT_NEAR(fit.thickness, 3.6, 0.3);
}

TEST(LayerModel, TellsBareBoneByItsSheathAndFat) {
  const LayerModel t1(kT1, 0.4), dess(kDess, 0.4);
  for (const double sheath : {0.0, 1.0, 2.2}) {
    const double dark = 26.0;
    const VecX fat =
        blurred_layers({{-100.0, 190.0}, {-1.5, 20.0}, {0.0, dark}, {sheath, 195.0}}, 0.4);
    EXPECT_LT(t1.fit(fat).evidence, 0.0) << sheath;
    const VecX muscle =
        blurred_layers({{-100.0, 65.0}, {-1.5, 20.0}, {0.0, 50.0}, {sheath, 90.0}}, 0.4);
    EXPECT_LT(dess.fit(muscle).evidence, -10.0) << sheath;
  }
}

TEST(LayerModel, DoubtsCartilageBeyondWhatIsNoBone) {
  const LayerModel model(kDess, 0.4);
  const VecX right = covered(kDess, 0.0, 0.8, 1.5, 60.0);
  TissueBrightness fossa = kDess;
  fossa.marrow = 110.0;
  const VecX wrong = covered(fossa, 0.0, 0.8, 1.5, 60.0);
  EXPECT_LT(model.fit(wrong).evidence, model.fit(right).evidence - 3.0);
}

TEST(LayerModel, StandsNoise) {
  const LayerModel model(kT1, 0.4);
  Rng rng(3);
  const VecX clean = covered(kT1, 0.3, 1.0, 1.6, 30.0);
  double bone = 0.0, thickness = 0.0;
  constexpr int kDraws = 40;
  for (int draw = 0; draw < kDraws; ++draw) {
    VecX noisy = clean;
    for (double& value : noisy) value += 8.0 * rng.normal();
    const LayerFit fit = model.fit(noisy);
    bone += fit.bone / kDraws;
    thickness += fit.thickness / kDraws;
  }
  EXPECT_NEAR(bone, 0.3, 0.15);
  EXPECT_NEAR(thickness, 1.6, 0.2);
}

TEST(LayerModel, RefusesABlurOrNoiseOfNothing) {
  EXPECT_THROW(LayerModel(kT1, 0.0), Error);
  EXPECT_THROW(LayerModel({190.0, 20.0, 95.0, 6.0, 0.0}, 0.4), Error);
  EXPECT_THROW(LayerModel(kT1, 0.4, {-4.0, 0.1, 100}), Error);
}

}  // namespace coxa::segment
