#include "base/probe_folder.h"

#include <system_error>
#include <vector>

#include "base/file.h"

namespace vismap {

namespace fs = std::filesystem;

NewFolders::NewFolders(const fs::path& folder) {
  std::error_code error;
  for (fs::path part = fs::absolute(folder, error).lexically_normal();
       !error && !part.empty() && !fs::exists(part, error); part = part.parent_path()) {
    if (part.has_filename()) folders_.push_back(part);
    if (part == part.parent_path()) break;
  }
}

void NewFolders::RemoveEmpty() const {
  std::error_code ignored;
  for (const fs::path& folder : folders_) {
    if (fs::is_directory(folder, ignored) && fs::is_empty(folder, ignored))
      fs::remove(folder, ignored);
  }
}

Result<void> ProbeFolder(const fs::path& folder, uint64_t bytes) {
  const NewFolders created(folder);
  Result<void> usable = CreateFolder(folder);
  if (usable) {
    const fs::path file = folder / ".vismap-probe";
    usable = WriteFileAtomically(file, std::vector<uint8_t>(bytes, 1));
    std::error_code ignored;
    fs::remove(file, ignored);
  }
  if (usable) return {};
  created.RemoveEmpty();
  return Fail("nothing can be written to the folder " + folder.string() + ": " +
              usable.error().message);
}

}  // namespace vismap
