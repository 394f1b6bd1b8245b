#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace vismap {

// What the web server lets a browser ask. Texts here come from strangers.

/// An answer to a GET.
struct HttpAnswer {
  int status = 200;
  std::string content_type = "application/json";
  std::vector<uint8_t> body{};
  std::string file_name{};  ///< not empty: browsers save it under this name
};
HttpAnswer JsonAnswer(const std::string& json);
/// {"error": sentence}
HttpAnswer ErrorAnswer(int status, const std::string& sentence);

/// Fails unless the Host header names this computer: an IP address, localhost, `computer`,
/// `computer`.local or one of `hosts`, each with or without a port. Otherwise a foreign page could
/// read the map under a name of its own that leads here.
Result<void> CheckHost(std::string_view host, const std::string& computer,
                       const std::vector<std::string>& hosts);
/// Fails unless a page of this server sent the request: when there is an Origin header, it must be
/// that of the Host header. Programs that are no browsers send none.
Result<void> CheckOrigin(std::optional<std::string_view> origin, std::string_view host);

/// Fails when a browser says that a page of another site sent the request. `fetch_site` is the
/// header Sec-Fetch-Site, which programs that are no browsers do not send.
Result<void> CheckSite(std::string_view fetch_site, std::optional<std::string_view> origin,
                       std::string_view host);

/// The target of a request, as in GET /api/slice?axis=z&at=1.0.
struct HttpTarget {
  std::string path;
  std::map<std::string, std::string> query;
};
/// Decodes percent signs. Fails on targets that do not begin with '/', on wrong percent signs, on
/// control characters, on a key that comes twice, and on more than 16 keys.
Result<HttpTarget> ParseTarget(std::string_view target);

/// A file of the page. Of its folder only regular files are read whose path has no part that begins
/// with a dot and leads, also through symbolic links, to no other place; of at most 64 MB.
/// Everything else is answered by 404.
HttpAnswer ReadPageFile(const std::string& folder, const std::string& path);

/// What stands in the place of a page that was not built.
HttpAnswer MissingPage();

}  // namespace vismap
