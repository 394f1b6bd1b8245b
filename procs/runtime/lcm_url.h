#pragma once

#include <cstdint>
#include <string>

#include "base/result.h"

namespace vismap {

/// The URL of the bus when none is given: $LCM_DEFAULT_URL, else tcpq://127.0.0.1:7700.
std::string DefaultLcmUrl();

/// A numeric IPv4 address and a port.
struct TcpAddress {
  std::string host;  ///< for example "127.0.0.1"
  uint16_t port = 0;
};

/// Parses "127.0.0.1:7700" or "127.0.0.1" (port 7700). Fails on host names, because LCM replaces a
/// name that it cannot parse by the address of this computer.
Result<TcpAddress> ParseTcpAddress(const std::string& text);

/// A checked LCM URL.
struct LcmUrl {
  std::string text;        ///< for LCM, with the options that vismap needs
  std::string provider;    ///< "tcpq", "udpm", "memq", ...
  TcpAddress hub;          ///< address of the hub, only for tcpq
  int receive_buffer = 0;  ///< requested size [bytes], only for udpm
};

/// Parses an LCM URL. Fails on a URL that LCM would misinterpret without an error. Adds a receive
/// buffer of 4 MB to a udpm URL that has none: with the system's default, LCM loses messages above
/// 130 kB.
Result<LcmUrl> ParseLcmUrl(const std::string& url);

/// Succeeds when a hub with LCM's tcpq protocol answers within `timeout` [s].
Result<void> ProbeHub(const TcpAddress& hub, double timeout);

/// Succeeds when the kernel grants a receive buffer of `bytes`. Otherwise the error names the
/// command that raises the limit.
Result<void> ProbeReceiveBuffer(int bytes);

}  // namespace vismap
