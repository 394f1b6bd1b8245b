#include "client/navigation_parts.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <functional>
#include <utility>

#include "client/leaf_distances.h"
#include "client/tree_checks.h"
#include "runtime/clock.h"
#include "wire/grid_message.h"

namespace vismap {
namespace {

constexpr double kRepeatPeriod = 3;        // of a request without a reply [s]
constexpr double kStatusPeriod = 0.5;      // [s]
constexpr double kAskPeriod = 2;           // for distances that are missing [s]
constexpr double kRestAfterTooLarge = 60;  // before distances that were too large are asked for [s]

bool OfOneGrid(const occupancy_grid_t& a, const occupancy_grid_t& b) {
  return a.map_id == b.map_id && a.revision == b.revision && a.states == b.states &&
         a.distances_m == b.distances_m;
}

}  // namespace

std::string TurnUntil(const std::atomic<bool>& stopping, const std::function<void()>& turn) {
  const std::string ended = "the thread that handles messages has ended: ";
  try {
    while (!stopping) turn();
    return "";
  } catch (const std::exception& error) {
    return ended + error.what();
  } catch (...) {
    return ended + "an exception that says nothing";
  }
}

OutputName NameOf(TreeKind kind) { return {ChannelOf(kind), "tree", ""}; }
OutputName GridName() { return {"GRID", "grid", "octomap_exporter.grid_period_s"}; }
OutputName DistancesName() {
  return {"DISTANCES", "field of distances", "octomap_exporter.distance_limit_m"};
}

NavigationClient::Parts::Parts(const NavigationClientOptions& given)
    : options(given),
      next_id(WallUtime()),
      client({given.url, given.name, given.connect_timeout_s, given.channel_prefix}) {}

void NavigationClient::Parts::Subscribe() {
  for (const TreeKind kind : options.trees) {
    trees[kind];
    client.Subscribe<octree_t>(
        ChannelOf(kind), [this, kind](const octree_t& message) { OnTree(kind, message); }, true);
  }
  if (options.grid) {
    client.Subscribe<occupancy_grid_t>(
        "GRID", [this](const occupancy_grid_t& message) { OnGrid(message); }, true);
  }
  if (options.distances) {
    client.Subscribe<distance_field_t>(
        "DISTANCES", [this](const distance_field_t& message) { OnDistances(message); });
  }
  client.Subscribe<navigation_status_t>(
      "NAVIGATION", [this](const navigation_status_t& message) { OnStatus(message); }, true);
  client.Subscribe<process_status_t>(
      "STATUS", [this](const process_status_t& message) { OnProcess(message); });
  client.Subscribe<map_reply_t>("MAP_REPLY",
                                [this](const map_reply_t& message) { OnReply(message); });
}

// What is decoded, made and freed is done while the mutex is free.
template <typename Value>
void NavigationClient::Parts::Replace(Kept<Value>* kept, std::shared_ptr<const Value> value,
                                      std::string map_id, int64_t revision, std::string problem) {
  const double now = MonotonicSeconds();
  const std::lock_guard lock(mutex);
  news.exporter_heard = now;
  kept->state.problem.swap(problem);
  if (value) {
    kept->value.swap(value);
    kept->state.Renew(std::move(map_id), revision, news, options.max_silence_s, now);
  }
  Notify();
}

void NavigationClient::Parts::Notify() {
  ++changes;
  changed.notify_all();
}

// The same tree comes again while the map stands still: also while the map server is dead.
void NavigationClient::Parts::OnTree(TreeKind kind, const octree_t& message) {
  const std::shared_ptr<const octree_t> before = Copy(KeptTree(kind)).first.value;
  const bool same = before && OfOneState(*before, message);
  std::string problem = same ? "" : ProblemOf(kind, message);
  auto tree = same || !problem.empty() ? nullptr : std::make_shared<const octree_t>(message);
  Replace<octree_t>(&KeptTree(kind), std::move(tree), message.map_id, message.revision,
                    std::move(problem));
}

void NavigationClient::Parts::OnGrid(const occupancy_grid_t& message) {
  const std::shared_ptr<const occupancy_grid_t> before = Copy(grid).first.value;
  const bool same = before && OfOneGrid(*before, message);
  std::string problem;
  if (!same) {
    const auto decoded = Decode(message);
    if (!decoded) problem = decoded.error().message;
    if (decoded && message.n_cells == 0) problem = "an empty grid has come on GRID";
  }
  auto copy =
      same || !problem.empty() ? nullptr : std::make_shared<const occupancy_grid_t>(message);
  Replace<occupancy_grid_t>(&grid, std::move(copy), message.map_id, message.revision,
                            std::move(problem));
}

void NavigationClient::Parts::OnDistances(const distance_field_t& message) {
  Result<DistanceUpdate> update = Decode(message);
  if (!update) return Replace<LeafDistances>(&distances, nullptr, "", -1, update.error().message);
  follower.GiveUpStaleParts(MonotonicSeconds());
  const FollowOutcome outcome = follower.Apply(std::move(*update), MonotonicSeconds());
  if (outcome == FollowOutcome::kTooLarge) {
    next_question = MonotonicSeconds() + kRestAfterTooLarge;
    return Replace<LeafDistances>(&distances, nullptr, "", -1,
                                  "the distances on DISTANCES need more than 1 GB");
  }
  std::shared_ptr<const LeafDistances> anew;
  if (outcome == FollowOutcome::kApplied) {
    anew = std::make_shared<const LeafDistances>(std::make_unique<const LeafDistances::Field>(
        LeafDistances::Field{follower.leaf_m(), follower.limit_m(), follower.Share()}));
  }
  Replace<LeafDistances>(&distances, std::move(anew), follower.position().map_id,
                         follower.position().revision, "");
  if (!follower.in_sync()) AskForDistances();
}

// The exporter answers on DISTANCES, or says why it has none.
void NavigationClient::Parts::AskForDistances() {
  const double now = MonotonicSeconds();
  if (now < next_question) return;
  next_question = now + kAskPeriod;
  map_request_t request{};
  request.verb = "distances-delta";
  request.argument = ToText(follower.position());
  request.unknown = map_request_t::UNKNOWN_DEFAULT;
  {
    const std::lock_guard lock(mutex);
    request.request_id = question = next_id++;
  }
  request.utime = WallUtime();
  client.Publish("MAP_REQUEST", std::move(request));
}

void NavigationClient::Parts::OnStatus(const navigation_status_t& message) {
  auto copy = std::make_shared<const navigation_status_t>(message);
  {
    const std::lock_guard lock(mutex);
    news.Hear(std::move(copy), MonotonicSeconds());
    for (auto& [kind, kept] : trees) kept.state.Confirm(ChannelOf(kind), news);
    grid.state.Confirm(GridName().channel, news);
    distances.state.Confirm(DistancesName().channel, news);
    Notify();
  }
  if (options.distances && !follower.in_sync()) AskForDistances();
}

void NavigationClient::Parts::OnProcess(const process_status_t& message) {
  if (message.process != "map-server" || message.state == "stopping") return;
  const std::lock_guard lock(mutex);
  news.server_heard = MonotonicSeconds();
}

void NavigationClient::Parts::OnReply(const map_reply_t& message) {
  if (message.requester != options.name) return;
  if (message.request_id == question) {
    if (!message.ok) Replace<LeafDistances>(&distances, nullptr, "", -1, message.message);
    return;
  }
  std::optional<map_reply_t> copy(message);  // not while planners may wait for the mutex
  const std::lock_guard lock(mutex);
  const auto found = requests.find(message.request_id);
  if (found == requests.end() || found->second.reply) return;
  found->second.reply.swap(copy);
  Notify();
}

bool NavigationClient::Parts::Turn(double timeout) {
  SendRequests();
  const bool handled = client.Handle(timeout);
  {
    const std::lock_guard lock(mutex);
    news.connected = client.connected();
  }
  if (MonotonicSeconds() >= next_state) TellState();
  return handled;
}

void NavigationClient::Parts::Fail(const std::string& why) {
  const std::lock_guard lock(mutex);
  news.failure = why;
  Notify();
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
  std::vector<std::pair<OutputName, OutputState>> outputs;
  for (const TreeKind kind : options.trees)
    outputs.emplace_back(NameOf(kind), Copy(KeptTree(kind)).first.state);
  if (options.grid) outputs.emplace_back(GridName(), Copy(grid).first.state);
  if (options.distances) outputs.emplace_back(DistancesName(), Copy(distances).first.state);
  for (const auto& [name, state] : outputs) {
    const std::string why =
        state.WhyStale(name, CopyNews(), options.max_silence_s, MonotonicSeconds());
    if (!why.empty()) return client.SetWaiting(why);
  }
  client.SetRunning();
}

ExporterNews NavigationClient::Parts::CopyNews() const {
  const std::lock_guard lock(mutex);
  return news;
}

NavigationClient::Parts::Trust NavigationClient::Parts::TrustIn(const OutputName& name,
                                                                const OutputState& state,
                                                                const ExporterNews& heard,
                                                                double max_age_s) const {
  const double now = MonotonicSeconds();
  Trust trust;
  trust.age_s =
      state.revision < 0 ? std::numeric_limits<double>::infinity() : now - state.confirmed;
  trust.why = state.WhyStale(name, heard, options.max_silence_s, now);
  if (trust.why.empty() && trust.age_s > max_age_s) {
    trust.why = "the newest " + name.noun + " on " + name.channel + " is " +
                SecondsText(trust.age_s) + " old, and one of at most " + SecondsText(max_age_s) +
                " is wanted";
  }
  trust.handed_out = trust.why.empty() || max_age_s == std::numeric_limits<double>::infinity();
  return trust;
}

void NavigationClient::Parts::WaitUntil(double timeout, const std::function<bool()>& condition) {
  const double end = MonotonicSeconds() + timeout;
  for (;;) {
    const int64_t seen = CountChanges();
    const double rest = end - MonotonicSeconds();
    if (condition() || rest <= 0 || !CopyNews().failure.empty()) return;
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

int64_t NavigationClient::Parts::Begin(map_request_t* request) {
  const std::lock_guard lock(mutex);
  request->request_id = next_id++;
  request->utime = WallUtime();
  requests[request->request_id].request = *request;
  return request->request_id;
}

std::optional<map_reply_t> NavigationClient::Parts::TakeReply(int64_t id) {
  const std::lock_guard lock(mutex);
  return std::exchange(requests.at(id).reply, std::nullopt);
}

void NavigationClient::Parts::Forget(int64_t id) {
  const std::lock_guard lock(mutex);
  requests.erase(id);
}

}  // namespace vismap
