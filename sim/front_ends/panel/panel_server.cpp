#include "sim/front_ends/panel/panel_server.hpp"

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <string_view>
#include <utility>

#include "sim/files_and_ports/ports/listening.hpp"
#include "sim/front_ends/panel/loopback.hpp"
#include "sim/front_ends/panel/panel.hpp"
#include "sim/text/embedded_files.hpp"
#include "sim/text/fail.hpp"

namespace ex9000::sim {

namespace {

namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using boost::asio::ip::tcp;
using boost::system::error_code;

constexpr std::uint16_t kDefaultPort = 9042;
/// Open pages: a limit against clients that never disconnect.
constexpr std::size_t kMostPages = 16;
/// In progress, without open pages. A browser sends up to six at a time, for all its pages together.
constexpr std::size_t kMostRequests = 64;
constexpr std::uint32_t kLongestHeader = 8192;
constexpr std::size_t kLongestPageRequest = 4096;
/// For each step: a request, its response, the handshake of a WebSocket.
constexpr std::chrono::seconds kRequestTimeout{5};
/// A page that sends nothing for this time, not even replies to pings, is disconnected.
constexpr std::chrono::seconds kIdle{20};
/// How often the state is captured: a page must show a change within 100 ms, with sending and drawing.
constexpr std::chrono::milliseconds kLookEvery{30};

tcp::endpoint here(std::uint16_t port) { return {boost::asio::ip::address_v4::loopback(), port}; }

/// For connections beyond the limit. Constant, so that it needs no memory for each connection.
constexpr std::string_view kTooManyRequestsResponse =
    "HTTP/1.1 503 Service Unavailable\r\nContent-Type: text/plain\r\nContent-Length: 34\r\n"
    "Connection: close\r\n\r\ntoo many requests are in progress\n";

std::string_view view_of(beast::string_view text) { return {text.data(), text.size()}; }

using Request = http::request<http::empty_body>;

const EmbeddedFile* page_file(std::string_view target) {
  for (const EmbeddedFile& file : page_files()) {
    if (target == "/" + std::string(file.name) || (target == "/" && file.name == "index.html")) {
      return &file;
    }
  }
  return nullptr;
}

std::string_view type_of(std::string_view file) {
  const std::string_view ending = file.substr(file.find('.') + 1);
  return ending == "html"  ? "text/html; charset=utf-8"
         : ending == "css" ? "text/css; charset=utf-8"
                           : "text/javascript; charset=utf-8";
}

}  // namespace

class PanelServer::Connections {
 public:
  Connections(boost::asio::io_context& io, std::optional<std::uint16_t> port, std::string models,
              Panel& panel)
      : listener_(io), next_look_(io), models_(std::move(models)), panel_(panel) {
    error_code error = listener_.listen(here(port.value_or(kDefaultPort)));
    if (error && !port) {
      error = listener_.listen(here(0));
    }
    if (error) {
      unavailable(std::to_string(port.value_or(kDefaultPort)) + ": " +
                  why_not_listening(error, "name another port"));
    }
  }

  [[nodiscard]] std::uint16_t port() const { return listener_.endpoint().port(); }
  void start() {
    listener_.start([this](tcp::socket socket) { admit(std::move(socket)); });
  }

 private:
  class Client;

  void admit(tcp::socket socket);
  /// Also those that are becoming pages.
  [[nodiscard]] std::size_t pages();
  void look();

  Listener<tcp> listener_;
  boost::asio::steady_timer next_look_;
  std::string models_;
  Panel& panel_;
  Clients<Client> clients_;
};

/// A single request, or a page that gets messages until it disconnects.
class PanelServer::Connections::Client : public std::enable_shared_from_this<Client> {
 public:
  Client(Connections& server, tcp::socket socket)
      : server_(server), socket_(beast::tcp_stream(std::move(socket))) {}

  void read_request() {
    parser_.header_limit(kLongestHeader);
    parser_.body_limit(0);
    stream().expires_after(kRequestTimeout);
    http::async_read(stream(), buffer_, parser_,
                     [self = shared_from_this()](const error_code& error, std::size_t /*size*/) {
                       self->have_request(error);
                     });
  }

  [[nodiscard]] bool is_page() const { return viewer_ != nullptr; }
  [[nodiscard]] bool takes_a_page() const { return takes_a_page_; }

  /// If there is a message, and the previous one has been sent.
  void tell() {
    if (!viewer_ || !outgoing_.empty()) {
      return;
    }
    outgoing_ = viewer_->next();
    if (outgoing_.empty()) {
      return;
    }
    socket_.async_write(boost::asio::buffer(outgoing_),
                        [self = shared_from_this()](const error_code& error, std::size_t /*size*/) {
                          self->outgoing_.clear();
                          if (error) {
                            self->end_page();
                            error_code ignored;
                            self->stream().socket().close(ignored);
                          } else if (self->answering_) {
                            self->answer_page_request();
                          }
                        });
  }

 private:
  beast::tcp_stream& stream() { return socket_.next_layer(); }

  void have_request(const error_code& error) {
    if (error == http::error::end_of_stream || error == boost::asio::error::operation_aborted ||
        error == beast::error::timeout) {
      return;
    }
    if (error == http::error::header_limit) {
      answer(http::status::request_header_fields_too_large,
             "the header is too long; expected up to 8192 bytes\n");
    } else if (error == http::error::body_limit && reads(parser_.get())) {
      answer(http::status::payload_too_large, "requests with a body are not supported\n");
    } else if (error && error != http::error::body_limit) {
      answer(http::status::bad_request, "the request is not valid HTTP\n");
    } else {
      serve(parser_.get());
    }
  }

  void serve(const Request& request) {
    const std::string_view host = view_of(request[http::field::host]);
    const auto origin = request.find(http::field::origin);
    const bool has_origin = origin != request.end();
    const bool live = request.target() == "/live";
    if (request.count(http::field::host) != 1 || !is_loopback_host(host)) {
      answer(http::status::forbidden,
             "the header Host is missing, wrong or repeated; expected 127.0.0.1 or localhost\n");
    } else if (request.count(http::field::origin) > 1 ||
               (has_origin && !is_origin_of(view_of(origin->value()), host)) || (live && !has_origin)) {
      answer(http::status::forbidden,
             "the header Origin is missing, wrong or repeated; expected the origin of the panel's page\n");
    } else if (!is_fetched_by_us(request)) {
      answer(http::status::forbidden, "requests from other sites are not allowed\n");
    } else if (!reads(request)) {
      answer(http::status::method_not_allowed, "only GET and HEAD are supported\n");
    } else if (live && !websocket::is_upgrade(request)) {
      answer(http::status::upgrade_required, "this path requires a WebSocket\n");
    } else if (live) {
      accept_page(request);
    } else if (request.target() == "/models.json") {
      answer(http::status::ok, server_.models_, "application/json");
    } else if (const EmbeddedFile* file = page_file(view_of(request.target()))) {
      answer(http::status::ok, file->content, type_of(file->name));
    } else {
      answer(http::status::not_found, "no such page\n");
    }
  }

  [[nodiscard]] static bool reads(const Request& request) {
    return request.method() == http::verb::get || request.method() == http::verb::head;
  }

  /// Browsers do not send Origin with every request. Newer ones also send Sec-Fetch-Site, with another value
  /// if a page of another origin has caused the request.
  [[nodiscard]] static bool is_fetched_by_us(const Request& request) {
    const auto fetched = request.equal_range("Sec-Fetch-Site");
    return std::all_of(fetched.first, fetched.second, [](const auto& field) {
      return field.value() == "same-origin" || field.value() == "none";
    });
  }

  void answer(http::status status, std::string_view text, std::string_view type = "text/plain") {
    response_.result(status);
    response_.version(11);
    response_.keep_alive(false);
    response_.set(http::field::content_type, beast::string_view(type.data(), type.size()));
    response_.set(http::field::cache_control, "no-store");
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("Content-Security-Policy",
                  "default-src 'self'; img-src 'self' data:; frame-ancestors 'none'; base-uri 'none'; "
                  "form-action 'none'");
    response_.set("Cross-Origin-Resource-Policy", "same-origin");
    response_.set("Referrer-Policy", "no-referrer");
    if (status == http::status::method_not_allowed) {
      response_.set(http::field::allow, "GET, HEAD");
    }
    response_.content_length(text.size());
    if (parser_.get().method() != http::verb::head) {
      response_.body() = text;
    }
    stream().expires_after(kRequestTimeout);
    http::async_write(
        stream(), response_,
        [self = shared_from_this()](const error_code& /*error*/, std::size_t /*size*/) { self->leave(); });
  }

  /// Reads the rest of the request, up to about 1 MiB: with bytes unread, the close would reset the
  /// connection, and the client could lose the response.
  void leave() {
    error_code ignored;
    stream().socket().shutdown(tcp::socket::shutdown_send, ignored);
    drain();
  }

  void drain() {
    constexpr std::size_t kMostDrained = 1 << 20;
    if (drained_ > kMostDrained) {
      return;
    }
    buffer_.clear();
    stream().async_read_some(buffer_.prepare(kLongestPageRequest),
                             [self = shared_from_this()](const error_code& error, std::size_t size) {
                               self->drained_ += size;
                               if (!error) {
                                 self->drain();
                               }
                             });
  }

  void accept_page(const Request& request) {
    takes_a_page_ = server_.pages() < kMostPages;
    stream().expires_never();
    websocket::stream_base::timeout timeout{};
    timeout.handshake_timeout = kRequestTimeout;
    timeout.idle_timeout = kIdle;
    timeout.keep_alive_pings = true;
    socket_.set_option(timeout);
    socket_.read_message_max(kLongestPageRequest);
    socket_.auto_fragment(false);
    socket_.async_accept(request, [self = shared_from_this()](const error_code& error) {
      if (error) {
        return;
      }
      if (!self->takes_a_page_) {
        // A browser tells the page why a WebSocket was closed, but not why it was rejected.
        self->close(websocket::close_code::try_again_later, "too many pages are open already");
      } else {
        self->buffer_.clear();
        self->viewer_ = self->server_.panel_.viewer();
        self->server_.look();
        self->read_page_request();
      }
    });
  }

  /// The connection stays open.
  void end_page() {
    if (const std::unique_ptr<PanelViewer> viewer = std::move(viewer_)) {
      viewer->leave();
    }
  }

  void close(websocket::close_code code, const char* why) {
    socket_.async_close({code, why}, [self = shared_from_this()](const error_code& /*error*/) {});
  }

  void read_page_request() {
    socket_.async_read(buffer_, [self = shared_from_this()](const error_code& error, std::size_t /*size*/) {
      if (error || !self->viewer_) {
        self->end_page();
        return;
      }
      self->answering_ = true;
      if (self->outgoing_.empty()) {
        self->answer_page_request();
      }
    });
  }

  /// Disconnects the page if the request is not valid. Reads the next one only when the reply to a command is
  /// queued, so a client cannot send commands faster than the server replies. Replies to console requests
  /// come later; the viewer limits their number.
  void answer_page_request() {
    answering_ = false;
    const std::string asked = beast::buffers_to_string(buffer_.data());
    buffer_.clear();
    if (!viewer_ || !socket_.got_text() || !viewer_->ask(asked)) {
      end_page();
      close(websocket::close_code::policy_error, "the message is not a valid request");
      return;
    }
    server_.look();
    read_page_request();
  }

  Connections& server_;
  websocket::stream<beast::tcp_stream> socket_;
  beast::flat_buffer buffer_{kLongestHeader + kLongestPageRequest};
  http::request_parser<http::empty_body> parser_;
  http::response<http::string_body> response_;
  std::size_t drained_ = 0;
  bool takes_a_page_ = false;
  std::unique_ptr<PanelViewer> viewer_;
  std::string outgoing_;    ///< the message that is being sent; empty: none
  bool answering_ = false;  ///< a request waits until the present message has been sent
};

void PanelServer::Connections::admit(tcp::socket socket) {
  if (clients_.all().size() - pages() < kMostRequests) {
    const auto client = std::make_shared<Client>(*this, std::move(socket));
    clients_.add(client);
    client->read_request();
  } else {
    error_code ignored;
    socket.write_some(boost::asio::buffer(kTooManyRequestsResponse), ignored);
  }
}

std::size_t PanelServer::Connections::pages() {
  const auto clients = clients_.all();
  return static_cast<std::size_t>(std::count_if(clients.begin(), clients.end(),
                                                [](const auto& client) { return client->takes_a_page(); }));
}

/// If a page is open: captures the state, sends each page its next message, and comes again in kLookEvery.
void PanelServer::Connections::look() {
  const auto clients = clients_.all();
  if (std::none_of(clients.begin(), clients.end(), [](const auto& client) { return client->is_page(); })) {
    return;
  }
  panel_.look();
  for (const auto& client : clients) {
    client->tell();
  }
  next_look_.expires_after(kLookEvery);
  next_look_.async_wait([this](const error_code& error) {
    if (!error) {
      look();
    }
  });
}

PanelServer::PanelServer(boost::asio::io_context& io, std::optional<std::uint16_t> port, std::string models,
                         Panel& panel)
    : connections_(std::make_unique<Connections>(io, port, std::move(models), panel)) {}

PanelServer::~PanelServer() = default;

std::string PanelServer::address() const {
  return "http://127.0.0.1:" + std::to_string(connections_->port()) + "/";
}

void PanelServer::start() { connections_->start(); }

}  // namespace ex9000::sim
