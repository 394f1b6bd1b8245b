#include "client/navigation.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <map>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vismap/navigation_status_t.hpp>
#include <vismap/process_status_t.hpp>

#include "client/client.h"
#include "runtime/clock.h"
#include "wire/octree_message.h"

namespace vismap {
namespace {

constexpr double kTurn = 0.01;         // longest wait of the thread for messages [s]
constexpr double kRepeatPeriod = 3;    // of a request without a reply [s]
constexpr double kStatusPeriod = 0.5;  // [s]
constexpr double kOverdue = 1.6;       // after so long a message once a second is missing [s]
constexpr double kNever = -std::numeric_limits<double>::infinity();

std::string ChannelOf(TreeKind kind) {
  switch (kind) {
    case TreeKind::kClosed:
      return "OCTOMAP";
    case TreeKind::kInflated:
      return "OCTOMAP_INFLATED";
    case TreeKind::kCoarse:
      return "OCTOMAP_COARSE";
    case TreeKind::kRaw:
      return "OCTOMAP_RAW";
  }
  throw std::invalid_argument("this kind of tree does not exist: " +
                              std::to_string(static_cast<int>(kind)));
}

std::string SecondsText(double seconds) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.1f s", seconds);
  return text;
}

bool IsClosed(const octree_t& tree) { return tree.unknown == octree_t::UNKNOWN_OCCUPIED; }

// "" = the tree can be handed out.
std::string ProblemOf(TreeKind kind, const octree_t& tree) {
  const auto decoded = Decode(tree);
  if (!decoded) return decoded.error().message;
  if (tree.n_nodes == 0) return "an empty tree has come on " + ChannelOf(kind);
  if (kind != TreeKind::kRaw && !IsClosed(tree)) {
    return "the tree on " + ChannelOf(kind) +
           " is raw, and planners would take unknown space for free; set octomap_exporter.unknown "
           "to OCCUPIED";
  }
  return "";
}

// What a reply carries, as on OCTOMAP.
octree_t TreeOf(map_reply_t reply) {
  octree_t tree{};
  tree.utime = reply.data_utime;
  tree.source = reply.source;
  tree.published_utime = reply.utime;
  tree.map_id = reply.map_id;
  tree.revision = reply.revision;
  tree.frame_id = "W";
  tree.tree_type = "OcTree";
  tree.encoding = reply.encoding == "bt" ? octree_t::ENCODING_BT : octree_t::ENCODING_OT;
  tree.unknown = reply.unknown;
  tree.resolution_m = reply.resolution_m;
  std::copy(reply.bbx_min_W, reply.bbx_min_W + 3, tree.bbx_min_W);
  std::copy(reply.bbx_max_W, reply.bbx_max_W + 3, tree.bbx_max_W);
  tree.shell_m = reply.shell_m;
  tree.inflated_by_m = reply.inflated_by_m;
  const auto checked = CheckOctree(reply.payload, "the reply");
  tree.n_nodes = checked ? checked->nodes : 0;
  tree.data = std::move(reply.payload);
  tree.data_size = static_cast<int32_t>(tree.data.size());
  return tree;
}

bool OfOneState(const octree_t& a, const octree_t& b) {
  return a.map_id == b.map_id && a.revision == b.revision && a.data == b.data;
}

}  // namespace

struct NavigationClient::Parts {
  struct Kept {
    std::shared_ptr<const octree_t> tree;
    double since = kNever;      // when it was received for the first time
    double confirmed = kNever;  // when it was known to be the newest state of the map
    std::string problem;        // why the message that came last is not `tree`
  };
  /// What the sentences about a tree are made of.
  struct Known {
    Kept kept;
    bool connected = false;
    double exporter_heard = kNever, server_heard = kNever;
    std::shared_ptr<const navigation_status_t> status;
  };
  struct Pending {
    map_request_t request;
    double send_at = 0;
    std::optional<map_reply_t> reply;
  };

  explicit Parts(const NavigationClientOptions& given)
      : options(given),
        client({given.url, given.name, given.connect_timeout_s, given.channel_prefix}),
        next_id(WallUtime()) {}

  void Subscribe();
  void OnTree(TreeKind kind, const octree_t& message);
  void OnStatus(const navigation_status_t& message);
  void OnReply(const map_reply_t& message);
  void OnProcess(const process_status_t& message);
  void Confirm(const std::string& channel, const navigation_status_t& status, Kept* kept) const;
  bool Turn(double timeout);
  void SendRequests();
  void TellState();
  Known KnownOf(TreeKind kind) const;
  std::string WhySilent(const Known& known, double now) const;
  std::string WhyStale(TreeKind kind, const Known& known, double now) const;
  template <typename Condition>
  void WaitUntil(double timeout, const Condition& condition);
  int64_t CountChanges() const;
  map_reply_t NoReply(const map_request_t& request, double timeout) const;

  const NavigationClientOptions options;
  Client client;  // for the thread that handles messages
  double next_state = 0;
  std::thread thread;
  std::atomic<bool> stopping{false};

  mutable std::mutex mutex;  // of what follows; held while pointers and numbers are copied
  std::condition_variable changed;
  int64_t changes = 0;
  std::map<TreeKind, Kept> trees;
  std::shared_ptr<const navigation_status_t> newest_status;
  double exporter_heard = kNever;
  double server_heard = kNever;     // by this client or by the exporter
  double server_followed = kNever;  // by the exporter alone
  bool connected = true;
  std::map<int64_t, Pending> requests;  // by request_id
  int64_t next_id;
};

void NavigationClient::Parts::Subscribe() {
  for (const TreeKind kind : options.trees) {
    trees[kind];
    client.Subscribe<octree_t>(
        ChannelOf(kind), [this, kind](const octree_t& message) { OnTree(kind, message); }, true);
  }
  client.Subscribe<navigation_status_t>(
      "NAVIGATION", [this](const navigation_status_t& message) { OnStatus(message); }, true);
  client.Subscribe<process_status_t>(
      "STATUS", [this](const process_status_t& message) { OnProcess(message); });
  client.Subscribe<map_reply_t>("MAP_REPLY",
                                [this](const map_reply_t& message) { OnReply(message); });
}

// The same tree comes again while the map stands still: also while the map server is dead.
void NavigationClient::Parts::OnTree(TreeKind kind, const octree_t& message) {
  const double now = MonotonicSeconds();
  const std::shared_ptr<const octree_t> before = KnownOf(kind).kept.tree;
  const bool same = before && OfOneState(*before, message);
  const std::string problem = same ? "" : ProblemOf(kind, message);
  auto tree = same || !problem.empty() ? nullptr : std::make_shared<const octree_t>(message);
  const std::lock_guard lock(mutex);
  exporter_heard = now;
  Kept& kept = trees[kind];
  kept.problem = problem;
  if (tree) {
    kept.tree.swap(tree);
    kept.since = now;
    const bool server_lives = now - server_followed <= options.max_silence_s;
    kept.confirmed = newest_status ? (server_lives ? now : server_followed) : kNever;
  }
  ++changes;
  changed.notify_all();
}

void NavigationClient::Parts::OnStatus(const navigation_status_t& message) {
  const double now = MonotonicSeconds();
  auto copy = std::make_shared<const navigation_status_t>(message);
  const std::lock_guard lock(mutex);
  exporter_heard = now;
  if (message.server_utime > 0) {
    const auto silent = static_cast<double>(message.published_utime - message.server_utime) * 1e-6;
    server_followed = std::max(server_followed, now - std::max(silent, 0.0));
    server_heard = std::max(server_heard, server_followed);
  }
  for (auto& [kind, kept] : trees) Confirm(ChannelOf(kind), message, &kept);
  newest_status.swap(copy);
  ++changes;
  changed.notify_all();
}

void NavigationClient::Parts::Confirm(const std::string& channel, const navigation_status_t& status,
                                      Kept* kept) const {
  if (!kept->tree || kept->tree->map_id != status.map_id) return;
  const auto found = std::find(status.channels.begin(), status.channels.end(), channel);
  if (found == status.channels.end()) return;
  const bool newest = status.in_sync && kept->tree->revision == status.revision;
  if (newest) {
    kept->confirmed = std::max(kept->confirmed, server_followed);
  } else if (kept->confirmed == kNever) {
    kept->confirmed = std::min(kept->since, server_followed);
  }
}

void NavigationClient::Parts::OnProcess(const process_status_t& message) {
  if (message.process != "map-server" || message.state == "stopping") return;
  const std::lock_guard lock(mutex);
  server_heard = MonotonicSeconds();
}

void NavigationClient::Parts::OnReply(const map_reply_t& message) {
  if (message.requester != options.name) return;
  std::optional<map_reply_t> copy(message);  // not while planners may wait for the mutex
  const std::lock_guard lock(mutex);
  const auto found = requests.find(message.request_id);
  if (found == requests.end() || found->second.reply) return;
  found->second.reply.swap(copy);
  ++changes;
  changed.notify_all();
}

bool NavigationClient::Parts::Turn(double timeout) {
  SendRequests();
  const bool handled = client.Handle(timeout);
  {
    const std::lock_guard lock(mutex);
    connected = client.connected();
  }
  if (MonotonicSeconds() >= next_state) TellState();
  return handled;
}

void NavigationClient::Parts::SendRequests() {
  std::vector<map_request_t> due;
  {
    const std::lock_guard lock(mutex);
    for (auto& [id, pending] : requests) {
      if (pending.reply || MonotonicSeconds() < pending.send_at) continue;
      pending.send_at = MonotonicSeconds() + kRepeatPeriod;
      due.push_back(pending.request);
    }
  }
  for (map_request_t& request : due) client.Publish("MAP_REQUEST", std::move(request));
}

void NavigationClient::Parts::TellState() {
  next_state = MonotonicSeconds() + kStatusPeriod;
  for (const TreeKind kind : options.trees) {
    const std::string why = WhyStale(kind, KnownOf(kind), MonotonicSeconds());
    if (!why.empty()) return client.SetWaiting(why);
  }
  client.SetRunning();
}

NavigationClient::Parts::Known NavigationClient::Parts::KnownOf(TreeKind kind) const {
  const std::lock_guard lock(mutex);
  const auto found = trees.find(kind);
  return {found == trees.end() ? Kept{} : found->second, connected, exporter_heard, server_heard,
          newest_status};
}

std::string NavigationClient::Parts::WhySilent(const Known& known, double now) const {
  if (!known.connected) return "there is no connection to the hub at present";
  if (known.exporter_heard == kNever) {
    return "nothing was heard of the octomap exporter yet; vismap-octomap-exporter is not running "
           "on this bus, or has just started";
  }
  const double exporter = now - known.exporter_heard, server = now - known.server_heard;
  const bool overdue = server > options.max_silence_s && exporter > kOverdue;
  if (exporter > options.max_silence_s || overdue)
    return "the octomap exporter was not heard for " + SecondsText(exporter);
  if (!known.status) return "nothing was heard on NAVIGATION yet";
  if (known.server_heard == kNever) return "the octomap exporter has not heard a map server yet";
  if (server > options.max_silence_s)
    return "the map server was not heard for " + SecondsText(server);
  return "";
}

std::string NavigationClient::Parts::WhyStale(TreeKind kind, const Known& known, double now) const {
  if (std::string silent = WhySilent(known, now); !silent.empty()) return silent;
  const Kept& kept = known.kept;
  const navigation_status_t& status = *known.status;
  if (!kept.problem.empty()) return kept.problem;
  if (!kept.tree) {
    return "no tree has come on " + ChannelOf(kind) + " yet" +
           (status.message.empty() ? "" : ": " + status.message);
  }
  if (!status.map_id.empty() && status.map_id != kept.tree->map_id)
    return "the map was replaced by another one, of which no tree has come on " + ChannelOf(kind);
  if (status.revision > kept.tree->revision && !status.message.empty()) return status.message;
  return "";
}

template <typename Condition>
void NavigationClient::Parts::WaitUntil(double timeout, const Condition& condition) {
  const double end = MonotonicSeconds() + timeout;
  for (;;) {
    const int64_t seen = CountChanges();
    const double rest = end - MonotonicSeconds();
    if (condition() || rest <= 0) return;
    const double turn = std::min(rest, 0.05);
    if (!thread.joinable()) {
      Turn(turn);
      continue;
    }
    std::unique_lock lock(mutex);
    changed.wait_for(lock, std::chrono::duration<double>(turn), [&] { return changes != seen; });
  }
}

int64_t NavigationClient::Parts::CountChanges() const {
  const std::lock_guard lock(mutex);
  return changes;
}

map_reply_t NavigationClient::Parts::NoReply(const map_request_t& request, double timeout) const {
  map_reply_t reply{};
  reply.request_id = request.request_id;
  reply.ok = false;
  const std::string silent = WhySilent(KnownOf(TreeKind::kClosed), MonotonicSeconds());
  reply.message = "no answer to the request '" + request.verb + "' within " + SecondsText(timeout) +
                  (silent.empty() ? "" : ": " + silent);
  return reply;
}

NavigationClient::NavigationClient(const NavigationClientOptions& options)
    : parts_(std::make_unique<Parts>(options)) {
  parts_->Subscribe();
}

NavigationClient::~NavigationClient() {
  parts_->stopping = true;
  if (parts_->thread.joinable()) parts_->thread.join();
}

void NavigationClient::Start() {
  if (parts_->thread.joinable()) throw std::logic_error("NavigationClient: Start was called twice");
  parts_->thread = std::thread([parts = parts_.get()] {
    while (!parts->stopping) parts->Turn(kTurn);
  });
}

bool NavigationClient::Handle(double timeout_s) {
  if (parts_->thread.joinable())
    throw std::logic_error("NavigationClient: after Start, a thread handles the messages");
  return parts_->Turn(timeout_s);
}

FreeSpace NavigationClient::Newest(TreeKind kind, double max_age_s) const {
  const std::vector<TreeKind>& kinds = parts_->options.trees;
  if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end())
    throw std::invalid_argument("NavigationClientOptions::trees has no " + ChannelOf(kind));
  const Parts::Known known = parts_->KnownOf(kind);
  const double now = MonotonicSeconds();
  FreeSpace space;
  space.tree = known.kept.tree;
  if (space.tree) space.age_s = now - known.kept.confirmed;
  space.why = parts_->WhyStale(kind, known, now);
  if (space.why.empty() && space.age_s > max_age_s) {
    space.why = "the newest tree is " + SecondsText(space.age_s) + " old, and one of at most " +
                SecondsText(max_age_s) + " is wanted";
  }
  space.stale = !space.why.empty();
  if (space.stale && max_age_s < std::numeric_limits<double>::infinity()) space.tree.reset();
  return space;
}

FreeSpace NavigationClient::WaitFor(TreeKind kind, double timeout_s, double max_age_s) {
  FreeSpace space = Newest(kind, max_age_s);
  parts_->WaitUntil(timeout_s, [&] {
    space = Newest(kind, max_age_s);
    return !space.stale;
  });
  return space;
}

FreeSpace NavigationClient::AskTree(const TreeRequest& request, double timeout_s) {
  map_request_t message{};
  message.verb = "octomap";
  message.has_bbx = request.box.has_value();
  if (request.box) {
    std::copy(request.box->min_W.begin(), request.box->min_W.end(), message.bbx_min_W);
    std::copy(request.box->max_W.begin(), request.box->max_W.end(), message.bbx_max_W);
  }
  message.resolution_m = request.resolution_m;
  message.unknown = request.raw ? map_request_t::UNKNOWN_ABSENT : map_request_t::UNKNOWN_OCCUPIED;
  message.inflate_m = request.inflate_m;
  message.without = request.without;
  map_reply_t reply = Ask(std::move(message), timeout_s);
  FreeSpace space;
  space.why = reply.message;
  if (!reply.ok) return space;
  octree_t tree = TreeOf(std::move(reply));
  space.why = ProblemOf(request.raw ? TreeKind::kRaw : TreeKind::kClosed, tree);
  if (!space.why.empty()) return space;
  const Parts::Known known = parts_->KnownOf(TreeKind::kClosed);
  const double now = MonotonicSeconds();
  space.tree = std::make_shared<const octree_t>(std::move(tree));
  space.age_s = known.server_heard == kNever ? 0 : now - known.server_heard;
  if (known.server_heard != kNever) space.why = parts_->WhySilent(known, now);
  space.stale = !space.why.empty();
  return space;
}

map_reply_t NavigationClient::Ask(map_request_t request, double timeout_s) {
  {
    const std::lock_guard lock(parts_->mutex);
    request.request_id = parts_->next_id++;
    request.utime = WallUtime();
    parts_->requests[request.request_id].request = request;
  }
  std::optional<map_reply_t> reply;
  parts_->WaitUntil(timeout_s, [&] {
    const std::lock_guard lock(parts_->mutex);
    reply.swap(parts_->requests.at(request.request_id).reply);
    return reply.has_value();
  });
  {
    const std::lock_guard lock(parts_->mutex);
    parts_->requests.erase(request.request_id);
  }
  return reply ? std::move(*reply) : parts_->NoReply(request, timeout_s);
}

}  // namespace vismap
