#include "viewer/http_rules.h"

#include <arpa/inet.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "base/file.h"
#include "base/printable.h"
#include "viewer/page_messages.h"

namespace vismap {
namespace {

constexpr uint64_t kMostFileBytes = 64 << 20;
constexpr size_t kMostKeys = 16, kMostShownText = 100;

std::string Lower(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return lower;
}

// A host without port: [::1]:8080 is ::1.
std::string HostName(std::string_view host) {
  if (host.starts_with('[')) {
    const size_t end = host.find(']');
    return end == std::string_view::npos ? "" : Lower(host.substr(1, end - 1));
  }
  return Lower(host.substr(0, host.rfind(':')));
}

bool IsAddress(const std::string& name) {
  in6_addr address{};
  return inet_pton(AF_INET, name.c_str(), &address) == 1 ||
         inet_pton(AF_INET6, name.c_str(), &address) == 1;
}

std::optional<int> HexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return std::nullopt;
}

Result<std::string> Unescape(std::string_view text) {
  std::string plain;
  for (size_t i = 0; i < text.size(); ++i) {
    char c = text[i];
    if (c == '%') {
      const auto high = i + 2 < text.size() ? HexDigit(text[i + 1]) : std::nullopt;
      const auto low = i + 2 < text.size() ? HexDigit(text[i + 2]) : std::nullopt;
      if (!high || !low) return Fail("a percent sign must stand before two hexadecimal digits");
      c = static_cast<char>(*high * 16 + *low);
      i += 2;
    } else if (c == '+') {
      c = ' ';
    }
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      return Fail("the address has a control character");
    plain += c;
  }
  return plain;
}

const char* ContentTypeOf(const std::string& extension) {
  static const std::map<std::string, const char*> kTypes = {
      {".html", "text/html; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".mjs", "text/javascript; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".json", "application/json"},
      {".txt", "text/plain; charset=utf-8"},
      {".svg", "image/svg+xml"},
      {".png", "image/png"},
      {".jpg", "image/jpeg"},
      {".ico", "image/x-icon"},
      {".wasm", "application/wasm"},
      {".webmanifest", "application/manifest+json"},
      {".map", "application/json"}};
  const auto found = kTypes.find(extension);
  return found == kTypes.end() ? "application/octet-stream" : found->second;
}

// No part of a path begins with a dot, and all its characters are harmless.
bool IsPlainPath(const std::string& path) {
  const bool plain = std::all_of(path.begin(), path.end(), [](unsigned char c) {
    return std::isalnum(c) || c == '/' || c == '.' || c == '-' || c == '_';
  });
  return plain && path.starts_with('/') && path.find("/.") == std::string::npos &&
         path.find("//") == std::string::npos;
}

std::optional<std::filesystem::path> FileInFolder(const std::string& folder,
                                                  const std::string& path) {
  std::error_code error;
  const auto root = std::filesystem::canonical(folder, error);
  if (error) return std::nullopt;
  const auto file = std::filesystem::canonical(root / path.substr(1), error);
  if (error || !std::filesystem::is_regular_file(file, error)) return std::nullopt;
  const auto [end, at] = std::mismatch(root.begin(), root.end(), file.begin(), file.end());
  return end == root.end() ? std::optional(file) : std::nullopt;
}

std::vector<uint8_t> BytesOfText(const std::string& text) { return {text.begin(), text.end()}; }

}  // namespace

HttpAnswer JsonAnswer(const std::string& json) {
  return {200, "application/json", BytesOfText(json), ""};
}

HttpAnswer ErrorAnswer(int status, const std::string& sentence) {
  return {status, "application/json", BytesOfText(ErrorText(sentence) + "\n"), ""};
}

Result<void> CheckHost(std::string_view host, const std::string& computer,
                       const std::vector<std::string>& hosts) {
  std::string name = HostName(host);
  if (IsAddress(name)) return {};
  if (name.ends_with('.')) name.pop_back();
  const std::string own = Lower(computer);
  if (name == "localhost" || (!own.empty() && (name == own || name == own + ".local"))) return {};
  for (const std::string& known : hosts) {
    if (name == Lower(known)) return {};
  }
  return Fail("the host '" + PrintableText(host, kMostShownText) +
              "' is not known as a name of this computer; use its address, or add the name to "
              "viewer.hosts in the config");
}

Result<void> CheckOrigin(std::optional<std::string_view> origin, std::string_view host) {
  if (!origin) return {};
  const std::string given = Lower(*origin), own = Lower(host);
  if (given == "http://" + own || given == "https://" + own) return {};
  return Fail("the request comes from a page of '" + PrintableText(*origin, kMostShownText) +
              "', and only pages of '" + PrintableText(host, kMostShownText) + "' may send it");
}

Result<void> CheckSite(std::string_view fetch_site, std::optional<std::string_view> origin,
                       std::string_view host) {
  const std::string site = Lower(fetch_site);
  if (site == "cross-site" || site == "same-site")
    return Fail("the request comes from a page of another place, and only pages of '" +
                PrintableText(host, kMostShownText) + "' may send it");
  return CheckOrigin(origin, host);
}

Result<HttpTarget> ParseTarget(std::string_view target) {
  if (!target.starts_with('/')) return Fail("the address must begin with '/'");
  const size_t question = target.find('?');
  Result<std::string> path = Unescape(target.substr(0, question));
  if (!path) return tl::unexpected(path.error());
  HttpTarget parsed{std::move(*path), {}};
  std::string_view rest =
      question == std::string_view::npos ? std::string_view() : target.substr(question + 1);
  while (!rest.empty()) {
    const std::string_view pair = rest.substr(0, rest.find('&'));
    rest.remove_prefix(std::min(rest.size(), pair.size() + 1));
    if (pair.empty()) continue;
    const size_t equals = pair.find('=');
    const auto key = Unescape(pair.substr(0, equals));
    const auto value = equals == std::string_view::npos ? Result<std::string>("")
                                                        : Unescape(pair.substr(equals + 1));
    if (!key) return tl::unexpected(key.error());
    if (!value) return tl::unexpected(value.error());
    if (parsed.query.size() >= kMostKeys) return Fail("the address has more than 16 arguments");
    if (!parsed.query.emplace(*key, *value).second)
      return Fail("the argument '" + PrintableText(*key, kMostShownText) + "' comes twice");
  }
  return parsed;
}

HttpAnswer ReadPageFile(const std::string& folder, const std::string& path) {
  const std::string name = path == "/" ? "/index.html" : path;
  const auto file = IsPlainPath(name) ? FileInFolder(folder, name) : std::nullopt;
  const auto missing = [&] {
    return ErrorAnswer(404, "there is no '" + PrintableText(path, kMostShownText) + "' here");
  };
  if (!file) return name == "/index.html" ? MissingPage() : missing();
  Result<std::vector<uint8_t>> bytes = ReadFileBytes(*file, kMostFileBytes);
  if (!bytes) return missing();
  return {200, ContentTypeOf(file->extension().string()), std::move(*bytes), ""};
}

HttpAnswer MissingPage() {
  static constexpr const char* kPage =
      "<!doctype html>\n<html lang=\"en\"><head><meta "
      "charset=\"utf-8\"><title>vismap</title></head>"
      "<body>\n<h1>The page of vismap was not built</h1>\n"
      "<p>vismap-viewer runs and answers, but the folder with its page is missing. Build it with "
      "<code>scripts/page</code> in the source folder of vismap; this needs nodejs (at least 18), "
      "npm "
      "and a connection to npm's registry. Then load this page again. "
      "<code>vismap-viewer --page FOLDER</code> takes a page from another folder.</p>\n"
      "<p>Without the page: <a href=\"/api/map\">/api/map</a>, <a "
      "href=\"/api/objects\">/api/objects</a>, <a href=\"/api/processes\">/api/processes</a>.</p>\n"
      "</body></html>\n";
  return {200, "text/html; charset=utf-8", BytesOfText(kPage), ""};
}

}  // namespace vismap
