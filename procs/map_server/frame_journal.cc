#include "map_server/frame_journal.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <utility>

#include "base/file.h"
#include "base/format.h"
#include "map_server/frame_intake.h"
#include "wire/envelope.h"

namespace vismap {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kEnding = ".frames";
constexpr size_t kNumberDigits = 8;
constexpr uint64_t kMostFileBytes = uint64_t{1} << 30;  // that are read

// The number of a file of a journal; nullopt for other files.
std::optional<uint64_t> NumberOf(const fs::path& path) {
  const std::string name = path.filename().string();
  if (name.size() != kNumberDigits + kEnding.size() || !name.ends_with(kEnding)) return {};
  const std::string digits = name.substr(0, kNumberDigits);
  if (digits.find_first_not_of("0123456789") != std::string::npos) return {};
  return std::stoull(digits);
}

std::string Reason() { return std::strerror(errno); }

Result<void> WriteAll(int fd, std::span<const uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return Fail(Reason());
    bytes = bytes.subspan(static_cast<size_t>(written));
  }
  return {};
}

Result<std::vector<uint8_t>> ReadPart(const fs::path& path, uint64_t offset, uint64_t bytes) {
  const int fd = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) return Fail(path.string() + ": " + Reason());
  std::vector<uint8_t> part(bytes);
  size_t have = 0;
  while (have < bytes) {
    const ssize_t more =
        pread(fd, part.data() + have, bytes - have, static_cast<off_t>(offset + have));
    if (more < 0 && errno == EINTR) continue;
    if (more <= 0) break;
    have += static_cast<size_t>(more);
  }
  close(fd);
  if (have < bytes) return Fail(path.string() + ": the file ends within a frame");
  return part;
}

}  // namespace

Result<std::unique_ptr<FrameJournal>> FrameJournal::Open(const fs::path& folder,
                                                         const FrameJournalLimits& limits) {
  if (const Result<void> made = CreateFolder(folder); !made) return tl::unexpected(made.error());
  std::unique_ptr<FrameJournal> journal(new FrameJournal(folder, limits));
  journal->limits_.file_bytes = std::min(
      {limits.file_bytes, std::max<uint64_t>(limits.max_bytes / 4, 1), kMostFileBytes / 2});
  if (const Result<void> read = journal->ReadFiles(); !read) return tl::unexpected(read.error());
  journal->thread_ = std::thread([made = journal.get()] { made->Run(); });
  return journal;
}

FrameJournal::~FrameJournal() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
  if (fd_ >= 0) close(fd_);
}

fs::path FrameJournal::PathOf(uint64_t file) const {
  std::string digits = std::to_string(file);
  digits.insert(0, kNumberDigits - std::min(kNumberDigits, digits.size()), '0');
  return folder_ / (digits + std::string(kEnding));
}

Result<void> FrameJournal::ReadFiles() {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_, error)) {
    if (const auto number = NumberOf(entry.path())) files_[*number] = 0;
  }
  if (error) return Fail(folder_.string() + ": cannot read the folder: " + error.message());
  for (auto& [number, size] : files_) {
    const fs::path path = PathOf(number);
    const Result<std::vector<uint8_t>> bytes = ReadFileBytes(path, kMostFileBytes);
    if (!bytes) return tl::unexpected(bytes.error());
    size = bytes->size();
    Index(number, *bytes, path.string());
  }
  return {};
}

void FrameJournal::Index(uint64_t file, std::span<const uint8_t> bytes, const std::string& name) {
  ScannedJournal scanned = ScanJournal(bytes);
  for (const JournalRecord& record : scanned.records) {
    if (record.kind == JournalRecordKind::kPoses) {
      if (const auto poses = DecodePosesRecord(record.content)) SetPoses(*poses);
    } else if (record.kind == JournalRecordKind::kFrame) {
      const Result<FrameRecord> frame = DecodeFrameRecord(record.content);
      if (frame) Enter({frame->frame, file, record.offset, record.bytes.size()});
    } else {
      scanned.remarks.push_back("a record of an unknown kind is left out");
    }
  }
  for (const std::string& remark : scanned.remarks) remarks_.push_back(name + ": " + remark);
}

void FrameJournal::SetPoses(std::span<const JournaledPose> poses) {
  for (const JournaledPose& pose : poses) {
    const auto revision = revisions_.find(pose.key);
    if (revision == revisions_.end()) continue;
    entries_.at(revision->second).frame.T_W_C = pose.T_W_C;
    has_corrections_ = true;
  }
}

// The frames from this one on that the journal had are of a state of the map that is lost.
void FrameJournal::Enter(Entry entry) {
  const int64_t revision = entry.frame.revision;
  const auto lost = entries_.lower_bound(revision);
  for (auto at = lost; at != entries_.end(); ++at) revisions_.erase(at->second.frame.key);
  entries_.erase(lost, entries_.end());
  revisions_[entry.frame.key] = revision;
  entries_.emplace(revision, std::move(entry));
}

void FrameJournal::WaitUntilWritten(std::unique_lock<std::mutex>* lock) const {
  const uint64_t last = last_task_;
  changed_.wait(*lock, [&] { return done_tasks_ >= last; });
}

// What the files had. The lock must be held, and nothing must wait to be written.
void FrameJournal::Forget() {
  if (fd_ >= 0) close(std::exchange(fd_, -1));
  files_.clear();
  entries_.clear();
  revisions_.clear();
  trouble_.reset();
  has_corrections_ = false;
}

void FrameJournal::BeginMap() {
  std::unique_lock lock(mutex_);
  WaitUntilWritten(&lock);
  std::error_code ignored;
  for (const auto& [number, size] : files_) fs::remove(PathOf(number), ignored);
  Forget();
}

Result<fs::path> FrameJournal::BeginMapAside() {
  std::unique_lock lock(mutex_);
  WaitUntilWritten(&lock);
  std::error_code error;
  fs::path aside;
  for (int number = 1; aside.empty() || fs::exists(aside, error); ++number)
    aside = folder_ / ("unusable-" + std::to_string(number));
  if (const Result<void> made = CreateFolder(aside); !made) return tl::unexpected(made.error());
  for (const auto& [number, size] : files_) {
    fs::rename(PathOf(number), aside / PathOf(number).filename(), error);
    if (error) return Fail(PathOf(number).string() + ": cannot be moved: " + error.message());
  }
  Forget();
  return aside;
}

void FrameJournal::Add(JournaledFrame frame, segmented_frame_t message) {
  const size_t bytes = BytesOf(message);
  {
    const std::lock_guard lock(mutex_);
    Enter({frame, 0, 0, 0});
    if (waiting_bytes_ + bytes > limits_.waiting_bytes) {
      Lose(frame, "the disk is too slow: " + FormatBytes(waiting_bytes_) + " wait for it");
      return;
    }
    waiting_bytes_ += bytes;
    waiting_.push_back({std::move(frame), std::move(message), {}, bytes, ++last_task_});
  }
  changed_.notify_all();
}

Result<void> FrameJournal::AddPoses(std::vector<JournaledPose> poses) {
  std::unique_lock lock(mutex_);
  poses_error_.reset();
  waiting_.push_back({std::nullopt, {}, poses, 0, ++last_task_});
  changed_.notify_all();
  WaitUntilWritten(&lock);
  if (poses_error_) return tl::unexpected(*poses_error_);
  SetPoses(poses);
  return {};
}

std::vector<JournaledFrame> FrameJournal::Frames() const {
  const std::lock_guard lock(mutex_);
  std::vector<JournaledFrame> frames;
  frames.reserve(entries_.size());
  for (const auto& [revision, entry] : entries_) frames.push_back(entry.frame);
  return frames;
}

Result<segmented_frame_t> FrameJournal::Read(int64_t revision) const {
  const std::string name = folder_.string() + ", frame " + std::to_string(revision);
  std::unique_lock lock(mutex_);
  const auto entry = [&] { return entries_.find(revision); };
  changed_.wait(lock, [&] { return entry() == entries_.end() || entry()->second.bytes > 0; });
  if (entry() == entries_.end()) return Fail(name + ": the journal does not have it any more");
  const Entry found = entry()->second;
  lock.unlock();
  const auto bytes = ReadPart(PathOf(found.file), found.offset, found.bytes);
  if (!bytes) return tl::unexpected(bytes.error());
  const Result<JournalRecord> record = ReadJournalRecord(*bytes);
  if (!record) return Fail(name + ": " + record.error().message);
  const Result<FrameRecord> frame = DecodeFrameRecord(record->content);
  if (!frame) return Fail(name + ": " + frame.error().message);
  Result<segmented_frame_t> message =
      Unpack<segmented_frame_t>(frame->message, kSegmentedFrameChannel.max_bytes);
  if (!message) return Fail(name + ": " + message.error().message);
  return message;
}

std::optional<std::string> FrameJournal::trouble() const {
  const std::lock_guard lock(mutex_);
  return trouble_;
}

bool FrameJournal::has_corrections() const {
  const std::lock_guard lock(mutex_);
  return has_corrections_;
}

uint64_t FrameJournal::bytes() const {
  const std::lock_guard lock(mutex_);
  uint64_t bytes = 0;
  for (const auto& [number, size] : files_) bytes += size;
  return bytes;
}

size_t FrameJournal::size() const {
  const std::lock_guard lock(mutex_);
  return entries_.size();
}

// The lock must be held.
void FrameJournal::Lose(const JournaledFrame& frame, const std::string& reason) {
  const auto entry = entries_.find(frame.revision);
  if (entry != entries_.end() && entry->second.frame.key == frame.key) {
    revisions_.erase(frame.key);
    entries_.erase(entry);
  }
  if (trouble_) return;
  trouble_ = "the journal of frames " + folder_.string() + " is incomplete from frame " +
             std::to_string(frame.revision) + " (" + ToText(frame.key) + ") on: " + reason;
}

void FrameJournal::Run() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [this] { return ends_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    Task task = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    const Result<void> written = Write(&task);
    lock.lock();
    if (!written && task.frame) Lose(*task.frame, written.error().message);
    if (!written && !task.frame) poses_error_ = written.error();
    waiting_bytes_ -= task.bytes;
    done_tasks_ = task.number;
    changed_.notify_all();
  }
}

Result<void> FrameJournal::Write(Task* task) {
  if (!task->frame) return Append(EncodePosesRecord(task->poses));
  const std::vector<uint8_t> record = EncodeFrameRecord(*task->frame, PackRaw(task->message));
  if (const Result<void> written = Append(record); !written) return written;
  const std::lock_guard lock(mutex_);
  const auto& [number, size] = *files_.rbegin();
  const auto entry = entries_.find(task->frame->revision);
  if (entry != entries_.end() && entry->second.frame.key == task->frame->key) {
    entry->second.file = number;
    entry->second.offset = size - record.size();
    entry->second.bytes = record.size();
  }
  DropOldest();
  return {};
}

// After a failure the file ends as before.
Result<void> FrameJournal::Append(std::span<const uint8_t> record) {
  const auto size = [this] {
    const std::lock_guard lock(mutex_);
    return fd_ < 0 ? limits_.file_bytes : files_.rbegin()->second;
  };
  if (size() >= limits_.file_bytes) {
    if (const Result<void> made = NextFile(); !made) return made;
  }
  const Result<void> written = WriteAll(fd_, record);
  const std::lock_guard lock(mutex_);
  uint64_t& bytes = files_.rbegin()->second;
  if (!written) {
    if (ftruncate(fd_, static_cast<off_t>(bytes)) != 0) close(std::exchange(fd_, -1));
    return Fail(PathOf(files_.rbegin()->first).string() + ": " + written.error().message);
  }
  bytes += record.size();
  return {};
}

Result<void> FrameJournal::NextFile() {
  const std::lock_guard lock(mutex_);
  if (fd_ >= 0) close(std::exchange(fd_, -1));
  const uint64_t number = files_.empty() ? 1 : files_.rbegin()->first + 1;
  const fs::path path = PathOf(number);
  const int fd = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0644);
  if (fd < 0) return Fail(path.string() + ": " + Reason());
  const std::vector<uint8_t> prefix = JournalFilePrefix();
  if (const Result<void> written = WriteAll(fd, prefix); !written) {
    close(fd);
    unlink(path.c_str());
    return Fail(path.string() + ": " + written.error().message);
  }
  fd_ = fd;
  files_[number] = prefix.size();
  return {};
}

// The lock must be held.
void FrameJournal::DropOldest() {
  uint64_t bytes = 0;
  for (const auto& [number, size] : files_) bytes += size;
  while (bytes > limits_.max_bytes && files_.size() > 1) {
    const uint64_t oldest = files_.begin()->first;
    bytes -= files_.begin()->second;
    unlink(PathOf(oldest).c_str());
    files_.erase(files_.begin());
    for (auto at = entries_.begin();
         at != entries_.end() && at->second.file <= oldest && at->second.bytes > 0;) {
      revisions_.erase(at->second.frame.key);
      at = entries_.erase(at);
    }
  }
}

}  // namespace vismap
