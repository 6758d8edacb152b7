#pragma once

#include <filesystem>
#include <list>
#include <nlohmann/json.hpp>
#include <string>

#include "case_folder.h"

namespace coxa::serve {

/// Images on their way from the browser into a subject's folder that has none yet.
///
/// Files come one by one into a hidden folder, under numbers and never under the names the browser
/// gives; only a batch that can be read as an image is put in place. What is not taken is removed.
class Uploads {
 public:
  explicit Uploads(const CaseFolder& folder);
  ~Uploads();

  static constexpr std::size_t kLargestFile = std::size_t{512} << 20;    ///< bytes
  static constexpr std::size_t kLargestBatch = std::size_t{1536} << 20;  ///< bytes
  static constexpr int kMostFiles = 5000;                                ///< of a batch

  /// One file of a batch. @param batch 8 to 32 hexadecimal digits  @param name decides whether it
  /// is an image in one file or a slice of a DICOM folder
  /// @returns {"files", "bytes"} of the batch
  /// @throws Error bad_input for what is no batch's name or too much, or where the folder has an
  ///         image
  nlohmann::json add(const std::string& batch, const std::string& name, const std::string& bytes);

  /// {"batch", "side", "movement", "series"}: reads the batch as an image, puts it in place and
  /// writes subject.toml beside it. @returns {"image"}, the path in the folder
  /// @throws Error bad_input, bad_file where it is no image or the folder has one already
  nlohmann::json take(const nlohmann::json& wanted);

 private:
  struct Batch {
    std::string name;
    std::size_t bytes = 0;
    int files = 0;
    std::string image = {};  ///< file name of an image in one file; empty for DICOM
  };
  Batch& batch(const std::string& name);
  void drop(const std::string& name);
  void require_no_image() const;
  std::filesystem::path place(const std::string& batch) const;

  const CaseFolder& folder_;
  std::filesystem::path waiting_;
  std::list<Batch> batches_;
};

}  // namespace coxa::serve
