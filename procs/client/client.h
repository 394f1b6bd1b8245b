#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace vismap {

struct ClientOptions {
  /// URL of the bus: tcpq://A.B.C.D:PORT of a vismap-hub, or udpm://...; empty = $LCM_DEFAULT_URL,
  /// and tcpq://127.0.0.1:7700 without it.
  std::string url;
  /// Name of this program on the bus. Two programs with one name are a finding of vismap-doctor.
  std::string name = "client";
  double connect_timeout_s = 10;  ///< how long the constructor waits for the hub [s]
  /// Stands before the names of vismap's channels on the bus, as the option --channel-prefix of
  /// vismap's programs; the functions of Client take the names without it.
  std::string channel_prefix = {};
};

/// Totals of one channel since the client was made.
struct ClientCounters {
  int64_t received = 0;  ///< messages that arrived
  int64_t rejected = 0;  ///< messages that could not be decoded, or that were damaged
  int64_t lost = 0;      ///< messages that did not arrive, by their sequence numbers
  int64_t unsent = 0;    ///< messages that could not be sent
};

/// A connection to the bus of vismap for programs outside it, with typed messages. It fills in
/// sequence number, source and checksum of what it publishes, calls handlers only with messages
/// that decoded completely, reads messages of earlier releases, connects again when the hub was
/// restarted, and publishes STATUS once a second, so that vismap-doctor knows the program.
///
/// For use by one thread. The library is libvismap-client: find_package(vismap) gives the target
/// vismap::client, pkg-config the module vismap-client.
class Client {
 public:
  /// Connects to the bus. Throws std::runtime_error, which names the command that solves the
  /// problem, when the URL is wrong or no hub answers.
  explicit Client(const ClientOptions& options = {});
  ~Client();
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  /// Makes Handle call `handler` for the messages of a channel. `latest` = only for the newest one,
  /// when several wait; else for each. `Message` is one of vismap's types. Throws
  /// std::invalid_argument when the channel of vismap carries another type.
  template <typename Message>
  void Subscribe(const std::string& channel, std::function<void(const Message&)> handler,
                 bool latest = false);

  /// Sends a message; utime and the other fields are the caller's. Returns false, and counts it as
  /// unsent, when there is no connection or the message is larger than the channel allows. Throws
  /// as Subscribe.
  template <typename Message>
  bool Publish(const std::string& channel, Message message);

  /// Waits up to `timeout_s` [s] for messages, and handles those that have arrived. Returns true
  /// when there was one. Call it regularly: it also keeps the connection and STATUS alive.
  bool Handle(double timeout_s);

  bool connected() const;
  ClientCounters counters(const std::string& channel) const;

  /// What STATUS says about this program. Sentences name what it waits for or the latest problem.
  void SetRunning();
  void SetWaiting(const std::string& sentence);
  void Count(const std::string& counter, int64_t amount = 1);
  void SetCounter(const std::string& counter, int64_t value);
  /// Adds a duration [ms]; the next STATUS has the median and the maximum of each stage.
  void AddTiming(const std::string& stage, double ms);
  /// Tells the map server of the newest frame of a camera, so that it can say by how much the map
  /// is behind.
  void SawFrame(int camera_id, int64_t utime);
  /// Replaces what is wrong or suspect about one subject; vismap-doctor repeats it. Empty =
  /// nothing.
  void SetFindings(const std::string& subject, const std::vector<std::string>& sentences);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace vismap
