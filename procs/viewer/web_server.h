#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "runtime/bus.h"
#include "runtime/stop_signal.h"
#include "viewer/client_feed.h"
#include "viewer/http_rules.h"

namespace vismap {

/// Names a connected page.
using PageId = int64_t;

/// What a web server asks its owner.
class WebHandler {
 public:
  using Reply = std::function<void(HttpAnswer)>;
  virtual ~WebHandler() = default;

  /// A GET whose host was checked. `reply` is called once, now or later.
  virtual void OnGet(const HttpTarget& target, Reply reply) = 0;
  virtual void OnOpen(PageId page) = 0;
  virtual void OnClose(PageId page) = 0;
  /// A text from a page. An Error ends the connection, and the page is told the sentence.
  virtual Result<void> OnText(PageId page, std::string_view text) = 0;
  /// The next message for a page, asked for when the one before was sent, and after Wake.
  virtual std::optional<OutFrame> NextFrame(PageId page) = 0;
  /// Called about every 50 ms.
  virtual void OnTick() = 0;
};

struct WebServerOptions {
  std::string listen;  ///< ADDRESS:PORT, [ADDRESS]:PORT for IPv6; port 0 = any free one
  std::vector<std::string> hosts;
  int max_pages = 16;
};

/// HTTP and WebSocket (at /live) on one thread, in one loop with a bus. It bounds what strangers
/// can take: connections, the time and size of requests, the size and rate of messages from pages,
/// and one message on its way to each page. It knows GET and HEAD only. All answers have headers by
/// which browsers load nothing from other places and show the page in no frame.
class WebServer {
 public:
  /// Fails when the address is wrong or in use. `handler` must outlive it, but keep no Reply when
  /// it ends.
  static Result<std::unique_ptr<WebServer>> Open(const WebServerOptions& options,
                                                 WebHandler* handler);
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  /// "http://127.0.0.1:8080"
  std::string address() const;
  size_t pages() const;
  int64_t refused() const;  ///< requests and connections since the start

  /// Asks for the next message of all pages to which none is on its way.
  void Wake();
  /// Serves, and handles the messages of the bus, until stop is requested. `bus` = nullptr: there
  /// is none.
  void Run(Bus* bus, const StopSignal& stop);

 private:
  class Impl;
  explicit WebServer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace vismap
