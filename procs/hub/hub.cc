#include "hub/hub.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>
#include <vismap/process_status_t.hpp>

#include "runtime/clock.h"
#include "runtime/log.h"
#include "runtime/tcp_socket.h"
#include "runtime/version.h"
#include "wire/envelope.h"
#include "wire/fingerprint.h"

namespace vismap {
namespace {

constexpr size_t kReadPerTurn =
    size_t{2} << 20;  // so that one busy client does not starve the others [bytes]

void SetOption(int fd, int level, int option, int value) {
  setsockopt(fd, level, option, &value, sizeof(value));
}

SharedBytes MakeBytes(std::vector<uint8_t> bytes) {
  return std::make_shared<const std::vector<uint8_t>>(std::move(bytes));
}

SharedBytes PublishRecord(const std::string& channel, const std::vector<uint8_t>& data) {
  std::vector<uint8_t> bytes = TcpqPublishHead(channel, data.size());
  bytes.insert(bytes.end(), data.begin(), data.end());
  return MakeBytes(std::move(bytes));
}

std::string AddressText(const sockaddr_in& address) {
  char text[INET_ADDRSTRLEN] = {};
  inet_ntop(AF_INET, &address.sin_addr, text, sizeof(text));
  return std::string(text) + ":" + std::to_string(ntohs(address.sin_port));
}

}  // namespace

struct Hub::Client {
  Client(int socket, std::string address, size_t max_message_bytes)
      : fd(socket), name(std::move(address)), reader(TcpqMagic::kClient, max_message_bytes) {}
  ~Client() { close(fd); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  int fd;
  std::string name;
  RecordReader reader;
  Subscriptions subscriptions;
  std::deque<SharedBytes> queue;
  size_t queued_bytes = 0;
  size_t sent_of_first = 0;
  int64_t dropped = 0;
  bool dead = false;
};

Result<std::unique_ptr<Hub>> Hub::Open(const HubOptions& options) {
  std::unique_ptr<Hub> hub(new Hub(options));
  if (const Result<void> listening = hub->Listen(); !listening) {
    return Fail("cannot listen on " + options.listen.host + ":" +
                std::to_string(options.listen.port) + ": " + listening.error().message);
  }
  hub->start_utime_ = WallUtime();
  return hub;
}

Hub::Hub(const HubOptions& options) : options_(options), faults_(options.faults) {}

Hub::~Hub() {
  if (socket_ >= 0) close(socket_);
}

Result<void> Hub::Listen() {
  socket_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (socket_ < 0) return Fail(std::strerror(errno));
  SetOption(socket_, SOL_SOCKET, SO_REUSEADDR, 1);
  if (options_.socket_buffer_bytes > 0) {  // before listen(), so that connections inherit it
    SetOption(socket_, SOL_SOCKET, SO_RCVBUF, options_.socket_buffer_bytes);
    SetOption(socket_, SOL_SOCKET, SO_SNDBUF, options_.socket_buffer_bytes);
  }
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(options_.listen.port);
  inet_pton(AF_INET, options_.listen.host.c_str(), &address.sin_addr);
  if (bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) != 0 ||
      listen(socket_, 64) != 0) {
    return Fail(std::strerror(errno));
  }
  socklen_t size = sizeof(address);
  getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size);
  port_ = ntohs(address.sin_port);
  return {};
}

void Hub::Run(const StopSignal& stop, const std::function<void()>& each_round) {
  double next_status = 0;
  while (!stop.requested()) {
    if (MonotonicSeconds() >= next_status) {
      PublishStatus();
      next_status = MonotonicSeconds() + 1;
    }
    ServeOnce(stop, 250);
    each_round();
  }
}

void Hub::ServeOnce(const StopSignal& stop, int timeout_ms) {
  std::vector<pollfd> waiting = {{stop.fd(), POLLIN, 0}, {socket_, POLLIN, 0}};
  std::vector<Client*> polled;
  for (const std::unique_ptr<Client>& client : clients_) {
    const int events = POLLIN | (client->queue.empty() ? 0 : POLLOUT);
    waiting.push_back({client->fd, static_cast<short>(events), 0});
    polled.push_back(client.get());
  }
  if (poll(waiting.data(), waiting.size(), timeout_ms) <= 0) return;
  for (size_t i = 0; i < polled.size(); ++i) {
    if (waiting[i + 2].revents != 0) Read(*polled[i]);
  }
  for (Client* client : polled) Flush(*client);
  if (waiting[1].revents != 0) Accept();
  RemoveDead();
}

void Hub::Accept() {
  sockaddr_in address{};
  socklen_t size = sizeof(address);
  const int fd =
      accept4(socket_, reinterpret_cast<sockaddr*>(&address), &size, SOCK_NONBLOCK | SOCK_CLOEXEC);
  if (fd < 0) return;
  auto client = std::make_unique<Client>(fd, AddressText(address), options_.max_message_bytes);
  if (client_count() >= options_.max_clients) {
    ++counters_.clients_cut_off;
    LogWarningSometimes("full", client->name + " was refused: there are " +
                                    std::to_string(client_count()) + " clients already");
    return;
  }
  TuneTcp(fd);
  ++counters_.clients_accepted;
  LogDebug(client->name + " joined");
  Queue(*client, MakeBytes(TcpqHello(TcpqMagic::kHub)));
  Flush(*client);
  clients_.push_back(std::move(client));
}

void Hub::Read(Client& client) {
  const Result<void> read = client.reader.ReadFrom(
      client.fd, kReadPerTurn, [&](TcpqRecord record) { Take(client, std::move(record)); });
  if (read || client.dead) return;
  client.dead = true;
  if (read.error().message.empty()) {
    LogDebug(client.name + " left");
  } else {
    ++counters_.clients_cut_off;
    LogWarningSometimes("cut off", client.name + " " + read.error().message + "; cut off");
  }
}

void Hub::Take(Client& client, TcpqRecord record) {
  switch (record.kind) {
    case TcpqRecord::Kind::kPublish:
      ++counters_.received;
      counters_.received_bytes += static_cast<int64_t>(record.bytes->size());
      if (faults_.Drops(record.name)) {
        ++counters_.dropped_on_purpose;
        return;
      }
      return Route(record.name, record.bytes);
    case TcpqRecord::Kind::kSubscribe:
      if (const Result<void> added = client.subscriptions.Add(record.name); !added) {
        client.dead = true;
        ++counters_.clients_cut_off;
        LogWarningSometimes("cut off", client.name + " " + added.error().message + "; cut off");
      }
      return;
    case TcpqRecord::Kind::kUnsubscribe:
      return client.subscriptions.Remove(record.name);
  }
}

void Hub::Route(const std::string& channel, const SharedBytes& bytes) {
  for (const std::unique_ptr<Client>& client : clients_) {
    if (!client->dead && client->subscriptions.Wants(channel)) Queue(*client, bytes);
  }
}

void Hub::Queue(Client& client, const SharedBytes& bytes) {
  if (!client.queue.empty() && client.queued_bytes + bytes->size() > options_.queue_bytes) {
    ++client.dropped;
    ++counters_.dropped;
    LogWarningSometimes("slow " + client.name,
                        client.name + " is too slow: " + std::to_string(client.dropped) +
                            " messages to it were dropped, its queue of " +
                            std::to_string(options_.queue_bytes) + " bytes is full");
    return;
  }
  client.queue.push_back(bytes);
  client.queued_bytes += bytes->size();
  ++counters_.delivered;
}

void Hub::Flush(Client& client) {
  while (!client.dead && !client.queue.empty()) {
    const std::vector<uint8_t>& first = *client.queue.front();
    const ssize_t sent = send(client.fd, first.data() + client.sent_of_first,
                              first.size() - client.sent_of_first, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0) {
      client.dead = errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR;
      return;
    }
    client.sent_of_first += static_cast<size_t>(sent);
    if (client.sent_of_first < first.size()) continue;
    client.queued_bytes -= first.size();
    client.sent_of_first = 0;
    client.queue.pop_front();
  }
}

void Hub::RemoveDead() {
  clients_.remove_if([](const std::unique_ptr<Client>& client) { return client->dead; });
}

void Hub::PublishStatus() {
  process_status_t message{};
  message.utime = WallUtime();
  message.seq = status_seq_++;
  message.source = "hub";
  message.process = "hub";
  char host[256] = {};
  gethostname(host, sizeof(host) - 1);
  message.host = host;
  message.pid = getpid();
  message.start_utime = start_utime_;
  message.state = "running";
  message.version = Version();
  message.types_fingerprint = TypesFingerprint();
  size_t queued = 0;
  for (const std::unique_ptr<Client>& client : clients_) queued += client->queued_bytes;
  message.counter_names = {"clients",        "clients_accepted", "clients_cut_off", "received",
                           "received_bytes", "delivered",        "dropped",         "queued_bytes"};
  message.counter_values = {
      client_count(),     counters_.clients_accepted,  counters_.clients_cut_off,
      counters_.received, counters_.received_bytes,    counters_.delivered,
      counters_.dropped,  static_cast<int64_t>(queued)};
  if (options_.faults.drop_fraction > 0) {
    message.message = "loses messages on purpose";
    message.counter_names.push_back("dropped_on_purpose");
    message.counter_values.push_back(counters_.dropped_on_purpose);
  }
  message.n_counters = static_cast<int32_t>(message.counter_names.size());
  Route(kStatusChannel.name, PublishRecord(kStatusChannel.name, Pack(message)));
  for (const std::unique_ptr<Client>& client : clients_) Flush(*client);
}

}  // namespace vismap
