#include "client/navigation.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "client/navigation_parts.h"
#include "client/tree_checks.h"
#include "runtime/clock.h"

namespace vismap {
namespace {

constexpr double kTurn = 0.01;  // longest wait of the thread for messages [s]

template <typename Parts, typename Newest>
auto WaitForFresh(Parts* parts, double timeout_s, const Newest& newest) {
  auto value = newest();
  parts->WaitUntil(timeout_s, [&] {
    value = newest();
    return !value.stale;
  });
  return value;
}

map_request_t MessageOf(const TreeRequest& request) {
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
  return message;
}

}  // namespace

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
    parts->Fail(TurnUntil(parts->stopping, [parts] { parts->Turn(kTurn); }));
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
  const auto [kept, news] = parts_->Copy(parts_->KeptTree(kind));
  Parts::Trust trust = parts_->TrustIn(NameOf(kind), kept.state, news, max_age_s);
  return {trust.handed_out ? kept.value : nullptr, trust.age_s, !trust.why.empty(),
          std::move(trust.why)};
}

WheelGrid NavigationClient::NewestGrid(double max_age_s) const {
  if (!parts_->options.grid)
    throw std::invalid_argument("NavigationClientOptions::grid is not set");
  const auto [kept, news] = parts_->Copy(parts_->grid);
  Parts::Trust trust = parts_->TrustIn(GridName(), kept.state, news, max_age_s);
  return {trust.handed_out ? kept.value : nullptr, trust.age_s, !trust.why.empty(),
          std::move(trust.why)};
}

KnownDistances NavigationClient::NewestDistances(double max_age_s) const {
  if (!parts_->options.distances)
    throw std::invalid_argument("NavigationClientOptions::distances is not set");
  const auto [kept, news] = parts_->Copy(parts_->distances);
  Parts::Trust trust = parts_->TrustIn(DistancesName(), kept.state, news, max_age_s);
  return {trust.handed_out ? kept.value : nullptr,
          kept.state.map_id,
          kept.state.revision,
          trust.age_s,
          !trust.why.empty(),
          std::move(trust.why)};
}

FreeSpace NavigationClient::WaitFor(TreeKind kind, double timeout_s, double max_age_s) {
  return WaitForFresh(parts_.get(), timeout_s, [&] { return Newest(kind, max_age_s); });
}

WheelGrid NavigationClient::WaitForGrid(double timeout_s, double max_age_s) {
  return WaitForFresh(parts_.get(), timeout_s, [&] { return NewestGrid(max_age_s); });
}

KnownDistances NavigationClient::WaitForDistances(double timeout_s, double max_age_s) {
  return WaitForFresh(parts_.get(), timeout_s, [&] { return NewestDistances(max_age_s); });
}

FreeSpace NavigationClient::AskTree(const TreeRequest& request, double timeout_s) {
  map_reply_t reply = Ask(MessageOf(request), timeout_s);
  FreeSpace space;
  space.why = reply.message;
  if (!reply.ok) return space;
  octree_t tree = TreeOf(std::move(reply));
  space.why = ProblemOf(request.raw ? TreeKind::kRaw : TreeKind::kClosed, tree);
  if (!space.why.empty()) return space;
  const ExporterNews news = parts_->CopyNews();
  const double now = MonotonicSeconds();
  space.tree = std::make_shared<const octree_t>(std::move(tree));
  space.age_s = news.server_heard == kNever ? 0 : now - news.server_heard;
  if (news.server_heard != kNever) space.why = news.WhySilent(parts_->options.max_silence_s, now);
  space.stale = !space.why.empty();
  return space;
}

map_reply_t NavigationClient::Ask(map_request_t request, double timeout_s) {
  const int64_t id = parts_->Begin(&request);
  std::optional<map_reply_t> reply;
  parts_->WaitUntil(timeout_s, [&] {
    reply = parts_->TakeReply(id);
    return reply.has_value();
  });
  parts_->Forget(id);
  if (reply) return std::move(*reply);
  map_reply_t none{};
  none.request_id = id;
  const std::string silent =
      parts_->CopyNews().WhySilent(parts_->options.max_silence_s, MonotonicSeconds());
  none.message = "no answer to the request '" + request.verb + "' within " +
                 SecondsText(timeout_s) + (silent.empty() ? "" : ": " + silent);
  return none;
}

}  // namespace vismap
