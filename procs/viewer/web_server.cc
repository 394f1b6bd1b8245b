#include "viewer/web_server.h"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <charconv>
#include <chrono>
#include <map>
#include <utility>

#include "base/printable.h"
#include "runtime/clock.h"
#include "runtime/log.h"

namespace vismap {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using ErrorCode = beast::error_code;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr seconds kRequestTime{10};   // for a request to arrive
constexpr seconds kAnswerTime{60};    // for an answer to be taken
constexpr seconds kIdlePageTime{30};  // a page that does not answer a ping for so long is gone
constexpr milliseconds kTick{50};
constexpr uint32_t kMostHeader = 8192, kMostBody = 1024;  // of a request [bytes]
constexpr size_t kMostPageMessage = 4096;                 // [bytes]
constexpr int kMostControlFrames = 50;   // pings and the like of a page, per second
constexpr int kSendBuffer = 1 << 19;     // [bytes]
constexpr size_t kMoreConnections = 32;  // besides those of pages
// Bodies of answers that are not sent yet, in sum; smaller ones are always sent.
constexpr size_t kMostAnswering = 192 << 20, kSmallAnswer = 1 << 16;

constexpr const char* kPolicy =
    "default-src 'self'; img-src 'self' blob: data:; frame-ancestors 'none'; base-uri 'none'; "
    "form-action 'none'";

using Request = http::request<http::string_body>;

std::string ComputerName() {
  char name[256] = {};
  return gethostname(name, sizeof name - 1) == 0 ? name : "";
}

std::string_view View(beast::string_view text) { return {text.data(), text.size()}; }

Result<tcp::endpoint> ParseListen(const std::string& listen) {
  const auto wrong = [&] {
    return Fail(
        "viewer.listen (--bind): expected ADDRESS:PORT with numbers, such as "
        "127.0.0.1:8080 or [::1]:8080, found '" +
        PrintableText(listen, 100) + "'");
  };
  const size_t colon = listen.rfind(':');
  if (colon == std::string::npos) return wrong();
  std::string host = listen.substr(0, colon);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']')
    host = host.substr(1, host.size() - 2);
  uint16_t port = 0;
  const char* end = listen.data() + listen.size();
  const auto [stop, failed] = std::from_chars(listen.data() + colon + 1, end, port);
  ErrorCode error;
  const asio::ip::address address = asio::ip::make_address(host, error);
  if (error || failed != std::errc() || stop != end) return wrong();
  return tcp::endpoint(address, port);
}

// The other end of a connection; "none" becomes 0.0.0.0.
asio::ip::address CallerOf(const tcp::socket& socket) {
  ErrorCode error;
  const asio::ip::address address = socket.remote_endpoint(error).address();
  if (error) return {};
  const bool mapped = address.is_v6() && address.to_v6().is_v4_mapped();
  return mapped ? asio::ip::make_address_v4(asio::ip::v4_mapped, address.to_v6()) : address;
}

// Programs of this computer may take all places.
bool IsHere(const asio::ip::address& address) {
  return address == asio::ip::address_v4::loopback() || address == asio::ip::address_v6::loopback();
}

template <typename Response>
void SetCommonHeaders(const Request& request, Response* response) {
  response->version(request.version() == 10 ? 10 : 11);
  response->keep_alive(request.keep_alive());
  response->set(http::field::server, "vismap-viewer");
  response->set(http::field::cache_control, "no-cache");
  response->set("Content-Security-Policy", kPolicy);
  response->set("X-Content-Type-Options", "nosniff");
  response->set("Referrer-Policy", "no-referrer");
  response->set("Cross-Origin-Resource-Policy", "same-origin");
}

}  // namespace

class WebServer::Impl {
 public:
  Impl(const WebServerOptions& options, WebHandler* handler)
      : options_(options), handler_(handler), acceptor_(io_), tick_(io_), retry_(io_), stop_(io_) {}

  Result<void> Listen() {
    const Result<tcp::endpoint> endpoint = ParseListen(options_.listen);
    if (!endpoint) return tl::unexpected(endpoint.error());
    ErrorCode error;
    acceptor_.open(endpoint->protocol(), error);
    if (!error) acceptor_.set_option(asio::socket_base::reuse_address(true), error);
    if (!error) acceptor_.bind(*endpoint, error);
    if (!error) acceptor_.listen(64, error);
    if (error)
      return Fail("cannot listen on " + options_.listen + " for browsers: " + error.message() +
                  "; choose another address with --bind ADDRESS:PORT, port 0 = any free one");
    return {};
  }

  std::string address() const {
    ErrorCode error;
    const tcp::endpoint at = acceptor_.local_endpoint(error);
    const std::string host = at.address().to_string();
    return "http://" + (at.address().is_v6() ? "[" + host + "]" : host) + ":" +
           std::to_string(at.port());
  }
  size_t pages() const { return pages_.size(); }
  int64_t refused() const { return refused_; }

  void Run(Bus* bus, const StopSignal& stop);
  void Wake();

 private:
  class Connection;
  class Page;
  struct Caller {
    size_t pages = 0, connections = 0;
  };
  // Counts a page or a connection of an address as long as it exists.
  class Place {
   public:
    Place(Impl* server, const asio::ip::address& address, size_t Caller::*kind)
        : server_(server), address_(address), kind_(kind) {
      ++(server_->callers_[address_].*kind_);
    }
    ~Place() {
      const auto caller = server_->callers_.find(address_);
      --(caller->second.*kind_);
      if (caller->second.pages == 0 && caller->second.connections == 0)
        server_->callers_.erase(caller);
    }
    Place(const Place&) = delete;
    Place& operator=(const Place&) = delete;
    const asio::ip::address& address() const { return address_; }

   private:
    Impl* server_;
    asio::ip::address address_;
    size_t Caller::*kind_;
  };
  // How many of `most` places one address may have, so that others find one, too.
  static size_t MostOfOne(const asio::ip::address& address, size_t most) {
    return IsHere(address) ? most : std::max<size_t>(1, most - std::max<size_t>(1, most / 4));
  }

  void Accept();
  void Take(tcp::socket socket);
  void Tick();
  void WatchBus();
  void HandleBus();

  WebServerOptions options_;
  WebHandler* handler_;
  const std::string computer_ = ComputerName();
  // Those that io_ ends count themselves here:
  size_t connections_ = 0;  // of HTTP
  size_t answering_ = 0;    // bodies of answers that are not sent yet [bytes]
  std::map<asio::ip::address, Caller> callers_;
  asio::io_context io_{1};
  tcp::acceptor acceptor_;
  asio::steady_timer tick_, retry_;
  asio::posix::stream_descriptor stop_;
  std::vector<std::unique_ptr<asio::posix::stream_descriptor>> bus_descriptors_;
  Bus* bus_ = nullptr;
  bool running_ = false, bus_is_next_ = false;
  std::map<PageId, std::shared_ptr<Page>> pages_;
  PageId next_page_ = 1;
  int64_t refused_ = 0;
};

// A page that is connected by a WebSocket. At most one message is on its way to it.
class WebServer::Impl::Page : public std::enable_shared_from_this<Page> {
 public:
  Page(Impl* server, beast::tcp_stream stream, const asio::ip::address& caller)
      : server_(server), place_(server, caller, &Caller::pages), socket_(std::move(stream)) {
    beast::get_lowest_layer(socket_).expires_never();
    websocket::stream_base::timeout limits{};
    limits.handshake_timeout = kRequestTime;
    limits.idle_timeout = kIdlePageTime;
    limits.keep_alive_pings = true;
    socket_.set_option(limits);
    socket_.read_message_max(kMostPageMessage);
    socket_.auto_fragment(false);
  }

  void Open(const Request& request) {
    // The answer of the handshake has the usual headers, too.
    socket_.set_option(websocket::stream_base::decorator([](websocket::response_type& response) {
      response.set(http::field::server, "vismap-viewer");
    }));
    const auto kept = std::make_shared<Request>(request);
    socket_.async_accept(*kept, [self = this->shared_from_this(), kept](ErrorCode error) {
      if (error) return self->Forget();
      self->is_open_ = true;
      self->WatchControlFrames();
      self->server_->handler_->OnOpen(self->id_);
      self->Read();
      self->Pump();
    });
  }

  void Pump() {
    if (!is_open_ || sending_.bytes != nullptr) return;
    std::optional<OutFrame> frame = server_->handler_->NextFrame(id_);
    if (!frame) return;
    sending_ = std::move(*frame);
    socket_.text(sending_.is_text);
    socket_.async_write(asio::buffer(*sending_.bytes),
                        [self = this->shared_from_this()](ErrorCode error, size_t) {
                          self->sending_ = {};
                          if (error) return self->Forget();
                          self->Pump();
                        });
  }

  void Shut() {
    ErrorCode ignored;
    beast::get_lowest_layer(socket_).socket().close(ignored);
  }

  PageId id_ = 0;

 private:
  void WatchControlFrames() {
    socket_.control_callback([this](websocket::frame_type, beast::string_view) {
      const double now = MonotonicSeconds();
      if (now - second_ >= 1) {
        second_ = now;
        control_frames_ = 0;
      }
      if (++control_frames_ > kMostControlFrames) Shut();
    });
  }

  void Read() {
    socket_.async_read(buffer_, [self = this->shared_from_this()](ErrorCode error, size_t) {
      if (error) return self->Forget();
      self->OnMessage();
    });
  }

  void OnMessage() {
    const auto bytes = buffer_.cdata();
    const std::string text(static_cast<const char*>(bytes.data()), bytes.size());
    buffer_.consume(buffer_.size());
    const Result<void> handled = socket_.got_text()
                                     ? server_->handler_->OnText(id_, text)
                                     : Fail("messages of a page must be text, not binary");
    if (!handled) return Refuse(handled.error().message);
    Read();
    Pump();
  }

  // Tells the page why the connection ends.
  void Refuse(const std::string& sentence) {
    constexpr size_t kMostReason = 120;  // the protocol allows 123 bytes
    ++server_->refused_;
    LogWarningRateLimited("page refused", "the connection of a page was ended: " + sentence);
    is_open_ = false;
    websocket::close_reason reason(websocket::close_code::policy_error);
    reason.reason = PrintableText(sentence, kMostReason);
    socket_.async_close(reason, [self = this->shared_from_this()](ErrorCode) { self->Forget(); });
  }

  void Forget() {
    is_open_ = false;
    if (id_ == 0) return;
    Shut();
    const PageId id = std::exchange(id_, 0);
    server_->handler_->OnClose(id);
    server_->pages_.erase(id);
  }

  Impl* server_;
  Place place_;
  websocket::stream<beast::tcp_stream, false> socket_;  // without compression
  beast::flat_buffer buffer_{kMostPageMessage};
  OutFrame sending_;
  bool is_open_ = false;
  double second_ = 0;
  int control_frames_ = 0;
};

// A connection of HTTP, with one request at a time.
class WebServer::Impl::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Impl* server, tcp::socket socket)
      : server_(server),
        place_(server, CallerOf(socket), &Caller::connections),
        stream_(std::move(socket)) {
    ++server_->connections_;
  }
  ~Connection() { --server_->connections_; }

  void Read() {
    parser_.emplace();
    parser_->header_limit(kMostHeader);
    parser_->body_limit(kMostBody);
    stream_.expires_after(kRequestTime);
    http::async_read(
        stream_, buffer_, *parser_,
        [self = this->shared_from_this()](ErrorCode error, size_t) { self->OnRead(error); });
  }

  const asio::ip::address& address() const { return place_.address(); }
  size_t OfItsAddress() const { return server_->callers_.at(address()).connections; }

  // Answers before a request was read.
  void RefuseAtOnce(int status, const std::string& sentence) {
    stream_.expires_after(kRequestTime);
    request_ = {};
    request_.version(11);
    request_.keep_alive(false);
    Refuse(status, sentence);
  }

 private:
  void OnRead(ErrorCode error) {
    if (error == http::error::header_limit)
      return RefuseAtOnce(431, "the header of the request is larger than 8192 bytes");
    if (error == http::error::body_limit) return RefuseAtOnce(413, "the request is too large");
    if (error && error.category() == http::make_error_code(http::error::bad_method).category() &&
        error != http::error::end_of_stream && error != http::error::partial_message)
      return RefuseAtOnce(400, "this is no HTTP request: " + error.message());
    if (error) return;  // closed, or too slow
    request_ = parser_->release();
    Serve();
  }

  void Serve() {
    const std::string host(View(request_[http::field::host]));
    if (const auto checked = CheckHost(host, server_->computer_, server_->options_.hosts); !checked)
      return Refuse(403, checked.error().message);
    if (request_.method() != http::verb::get && request_.method() != http::verb::head)
      return Refuse(405, "only GET is known here: nothing of the map can be changed by a request");
    const Result<HttpTarget> target = ParseTarget(View(request_.target()));
    if (!target) return Refuse(400, target.error().message);
    if (target->path == "/live") return OpenPage(host);
    if (target->path.starts_with("/api/")) {
      const std::string_view site = View(request_["Sec-Fetch-Site"]);
      if (const auto checked = CheckSite(site, Origin(), host); !checked)
        return Refuse(403, checked.error().message);
    }
    stream_.expires_after(kAnswerTime);
    server_->handler_->OnGet(*target, [self = this->shared_from_this()](HttpAnswer answer) {
      self->Send(std::move(answer));
    });
  }

  std::optional<std::string_view> Origin() const {
    const auto header = request_.find(http::field::origin);
    return header == request_.end() ? std::nullopt : std::optional(View(header->value()));
  }

  void OpenPage(const std::string& host) {
    if (!websocket::is_upgrade(request_))
      return Refuse(426, "/live is for WebSocket connections only");
    if (const auto checked = CheckOrigin(Origin(), host); !checked)
      return Refuse(403, checked.error().message);
    if (server_->pages_.size() >= static_cast<size_t>(server_->options_.max_pages))
      return Refuse(503, "there are " + std::to_string(server_->options_.max_pages) +
                             " pages already (viewer.max_clients); close one of them");
    const size_t most =
        MostOfOne(place_.address(), static_cast<size_t>(server_->options_.max_pages));
    if (server_->callers_[place_.address()].pages >= most)
      return Refuse(503, "there are " + std::to_string(most) +
                             " pages of your address already; close one of them");
    const auto page = std::make_shared<Page>(server_, std::move(stream_), place_.address());
    page->id_ = server_->next_page_++;
    server_->pages_.emplace(page->id_, page);
    page->Open(request_);
  }

  void Refuse(int status, const std::string& sentence) {
    ++server_->refused_;
    LogWarningRateLimited("request refused", "a request of a browser was refused: " + sentence);
    request_.keep_alive(false);
    Send(ErrorAnswer(status, sentence));
  }

  // The body of an answer, as long as it is on its way.
  struct Answer {
    explicit Answer(Impl* server, size_t size) : server_(server), size_(size) {
      server_->answering_ += size_;
    }
    ~Answer() { server_->answering_ -= size_; }
    Answer(const Answer&) = delete;
    Answer& operator=(const Answer&) = delete;
    http::response<http::vector_body<uint8_t>> response_;

   private:
    Impl* server_;
    size_t size_;
  };

  void Send(HttpAnswer answer) {
    if (answer.body.size() > kSmallAnswer &&
        server_->answering_ + answer.body.size() > kMostAnswering) {
      ++server_->refused_;
      answer = ErrorAnswer(503, "answers of " + std::to_string(server_->answering_ >> 20) +
                                    " MB wait for browsers that read slowly; try again later");
    }
    const auto kept = std::make_shared<Answer>(server_, answer.body.size());
    auto* response = &kept->response_;
    response->result(static_cast<unsigned>(answer.status));
    SetCommonHeaders(request_, response);
    response->set(http::field::content_type, answer.content_type);
    if (!answer.file_name.empty())
      response->set(http::field::content_disposition,
                    "attachment; filename=\"" + answer.file_name + "\"");
    if (answer.status == 405) response->set(http::field::allow, "GET, HEAD");
    response->content_length(answer.body.size());
    if (request_.method() != http::verb::head) response->body() = std::move(answer.body);
    stream_.expires_after(kAnswerTime);
    http::async_write(stream_, *response,
                      [self = this->shared_from_this(), kept](ErrorCode error, size_t) {
                        if (!error && kept->response_.keep_alive()) return self->Read();
                        ErrorCode ignored;
                        self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
                      });
  }

  Impl* server_;
  Place place_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{kMostHeader + kMostBody + 1024};
  std::optional<http::request_parser<http::string_body>> parser_;
  Request request_;
};

void WebServer::Impl::Accept() {
  acceptor_.async_accept([this](ErrorCode error, tcp::socket socket) {
    if (error == asio::error::operation_aborted) return;
    if (!error) {
      Take(std::move(socket));
      return Accept();
    }
    // For example too many open files: a pause, instead of a loop that takes all of the time.
    LogWarningRateLimited("accept", "a connection was not accepted: " + error.message());
    retry_.expires_after(milliseconds(100));
    retry_.async_wait([this](ErrorCode stopped) {
      if (!stopped) Accept();
    });
  });
}

void WebServer::Impl::Take(tcp::socket socket) {
  const size_t most = static_cast<size_t>(options_.max_pages) + kMoreConnections;
  if (connections_ >= 2 * most) {
    ++refused_;
    return;  // which closes the connection
  }
  ErrorCode ignored;
  socket.set_option(tcp::no_delay(true), ignored);
  // Little waits in the system for a slow page: what it reads would be old.
  socket.set_option(asio::socket_base::send_buffer_size(kSendBuffer), ignored);
  const auto connection = std::make_shared<Connection>(this, std::move(socket));
  if (connections_ > most) return connection->RefuseAtOnce(503, "there are too many connections");
  if (connection->OfItsAddress() > MostOfOne(connection->address(), most))
    return connection->RefuseAtOnce(503, "there are too many connections of your address");
  connection->Read();
}

void WebServer::Impl::Wake() {
  std::vector<std::shared_ptr<Page>> pages;  // sending may end pages
  for (const auto& entry : pages_) pages.push_back(entry.second);
  for (const auto& page : pages) page->Pump();
}

void WebServer::Impl::Tick() {
  tick_.expires_after(kTick);
  tick_.async_wait([this](ErrorCode error) {
    if (error || !running_) return;
    HandleBus();
    handler_->OnTick();
    Wake();
    Tick();
  });
}

// Waits on copies of the descriptors, and on new ones after each message: the bus may close and
// open its own at any time.
void WebServer::Impl::WatchBus() {
  bus_descriptors_.clear();
  if (bus_ == nullptr) return;
  for (const int descriptor : bus_->FileDescriptors()) {
    const int copy = dup(descriptor);
    if (copy < 0) continue;  // the tick handles messages, too
    bus_descriptors_.push_back(std::make_unique<asio::posix::stream_descriptor>(io_, copy));
    bus_descriptors_.back()->async_wait(asio::posix::descriptor_base::wait_read,
                                        [this](ErrorCode error) {
                                          if (!error && running_) HandleBus();
                                        });
  }
}

void WebServer::Impl::HandleBus() {
  if (bus_ == nullptr) return;
  bus_descriptors_.clear();
  if (bus_->Spin(0)) {
    // Browsers get their turn between two rounds of messages.
    if (!std::exchange(bus_is_next_, true)) {
      asio::post(io_, [this] {
        bus_is_next_ = false;
        if (running_) HandleBus();
      });
    }
    return;
  }
  WatchBus();
}

void WebServer::Impl::Run(Bus* bus, const StopSignal& stop) {
  bus_ = bus;
  running_ = true;
  stop_.assign(dup(stop.fd()));
  stop_.async_wait(asio::posix::descriptor_base::wait_read, [this](ErrorCode) { io_.stop(); });
  Accept();
  Tick();
  WatchBus();
  io_.run();
  running_ = false;
  bus_descriptors_.clear();
  for (const auto& entry : pages_) entry.second->Shut();
}

WebServer::WebServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
WebServer::~WebServer() = default;

Result<std::unique_ptr<WebServer>> WebServer::Open(const WebServerOptions& options,
                                                   WebHandler* handler) {
  auto impl = std::make_unique<Impl>(options, handler);
  if (const Result<void> listening = impl->Listen(); !listening)
    return tl::unexpected(listening.error());
  return std::unique_ptr<WebServer>(new WebServer(std::move(impl)));
}

std::string WebServer::address() const { return impl_->address(); }
size_t WebServer::pages() const { return impl_->pages(); }
int64_t WebServer::refused() const { return impl_->refused(); }
void WebServer::Wake() { impl_->Wake(); }
void WebServer::Run(Bus* bus, const StopSignal& stop) { impl_->Run(bus, stop); }

}  // namespace vismap
