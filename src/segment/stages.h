#pragma once

#include <coxa/core/monitor.h>
#include <coxa/segment/evolve.h>

#include <span>
#include <string>
#include <vector>

namespace coxa::segment {

/// The images smoothed by `sigma` mm; as they are for 0.
std::vector<PreparedImage> smoothed_images(const std::vector<PreparedImage>& images, double sigma);

/// Moves the bodies through all resolutions.
void update_through(std::vector<Body>& bodies, const std::vector<Resolution>& resolutions,
                    const std::vector<PreparedImage>& images,
                    const std::vector<Obstacles>& obstacles, const std::vector<TriMesh>& hosts,
                    const SegmentOptions& options, const Monitor& monitor);

/// The contrast whose profiles, after placing the bodies with them, fit this
/// image best, beside the images whose contrast is known already: a second
/// image with half the hip cannot mislead what the first one shows. Where the image has one
/// already, only that one and its variants are tried.
std::string best_contrast(const std::vector<Body>& bodies, std::span<const PreparedImage> known,
                          const PreparedImage& image, const Resolution& resolution,
                          const SegmentOptions& options);

}  // namespace coxa::segment
