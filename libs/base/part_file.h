#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <utility>

#include "base/result.h"

namespace vismap {

/// A file that is written from begin to end and gets its final name only in Finish; until then it
/// is PATH.part. So it may replace a file that is still being read, and an interrupted program
/// leaves no partial file under the final name.
class PartFile {
 public:
  /// Fails, naming the file, when it cannot be created.
  static Result<PartFile> Create(const std::filesystem::path& path);
  /// Removes the file when it is not finished.
  ~PartFile();
  PartFile(PartFile&&) = default;
  PartFile& operator=(PartFile&&) = delete;

  /// Appends bytes. Finish returns the first error.
  void Write(std::span<const uint8_t> bytes);
  /// Gives the file its final name. Fails with the first write error.
  Result<void> Finish();

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  using File = std::unique_ptr<std::FILE, Close>;
  PartFile(std::filesystem::path path, File file)
      : path_(std::move(path)), file_(std::move(file)) {}

  std::filesystem::path path_;
  File file_;
  int error_ = 0;  // errno of the first write that failed
};

}  // namespace vismap
