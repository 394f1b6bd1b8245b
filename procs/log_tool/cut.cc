#include "log_tool/cut.h"

#include <cmath>

#include "logs/log_writer.h"

namespace vismap {

bool Keeps(const CutOptions& options, const LogEvent& event, const std::string& own,
           int64_t start) {
  // Compare whole microseconds, as double, which cannot overflow.
  const double elapsed = static_cast<double>(event.timestamp) - static_cast<double>(start);
  return elapsed >= std::round(options.from * 1e6) &&
         (!options.to || elapsed < std::round(*options.to * 1e6)) &&
         (options.channels.empty() || options.channels.contains(event.channel) ||
          options.channels.contains(own));
}

Result<CutResult> CutLog(LogReader& reader, const CutOptions& options,
                         const std::filesystem::path& out) {
  Result<LogWriter> writer = LogWriter::Create(out);
  if (!writer) return tl::unexpected(writer.error());
  CutResult result;
  std::optional<int64_t> start;
  const auto on_event = [&](const LogEvent& event) -> Result<void> {
    if (!start) start = event.timestamp;
    if (!Keeps(options, event, reader.OwnChannel(event), *start)) {
      ++result.left_out;
      return {};
    }
    const Result<std::vector<uint8_t>> bytes = reader.ReadData(event);
    if (!bytes) return tl::unexpected(bytes.error());
    writer->Add(event.timestamp, event.channel, *bytes);
    ++result.kept;
    return {};
  };
  const Result<void> read = ForEachEvent(
      reader, on_event, [&](const LogDamage& damage) { result.damaged_bytes += damage.bytes; });
  if (!read) return tl::unexpected(read.error());
  if (!start) return Fail(reader.path() + ": the file has no LCM event");
  if (result.kept == 0)
    return Fail(reader.path() +
                ": no message of the log is in this time range and on these channels");
  if (const Result<void> finished = writer->Finish(); !finished)
    return tl::unexpected(finished.error());
  return result;
}

}  // namespace vismap
