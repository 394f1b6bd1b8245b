#include "runtime/main.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>

#include "hub/hub.h"

namespace {

using namespace vismap;

struct Arguments {
  std::string listen = "127.0.0.1:7700";
  size_t queue_mb = 256;
  HubOptions hub;
};

void AddOptions(CLI::App& app, Arguments* arguments) {
  app.add_option("--listen", arguments->listen,
                 "Address to listen on, numbers only; port 0 = any free one, printed")
      ->capture_default_str();
  app.add_option("--queue-mb", arguments->queue_mb,
                 "Megabytes that may wait for a slow client before it loses messages")
      ->check(CLI::Range(1, 65536))
      ->capture_default_str();
  app.add_option("--socket-buffer-bytes", arguments->hub.socket_buffer_bytes,
                 "Send and receive buffer of each connection; 0 = the system's")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--max-clients", arguments->hub.max_clients, "Connections beyond are refused")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
}

Outcome Serve(const Arguments& arguments, ProcessContext& context) {
  HubOptions options = arguments.hub;
  options.queue_bytes = arguments.queue_mb * kMegabyte;
  const Result<TcpAddress> listen = ParseTcpAddress(arguments.listen);
  if (!listen) return ExitWith(ExitCode::kUsage, "--listen: " + listen.error().message);
  options.listen = *listen;
  const Result<std::unique_ptr<Hub>> hub = Hub::Open(options);
  if (!hub) return ExitWith(ExitCode::kFailed, hub.error().message);
  std::printf("tcpq://%s:%d\n", listen->host.c_str(), (*hub)->port());
  std::fflush(stdout);
  (*hub)->Run(context.stop);
  const HubCounters& counters = (*hub)->counters();
  LogInfo("passed on " + std::to_string(counters.received) + " messages, dropped " +
          std::to_string(counters.dropped));
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  ProcessSpec spec;
  spec.name = "hub";
  spec.summary = "Passes messages between the processes of one bus over TCP (LCM's tcpq protocol).";
  spec.joins_bus = false;
  spec.add_options = [&](CLI::App& app) { AddOptions(app, &arguments); };
  spec.run = [&](ProcessContext& context) { return Serve(arguments, context); };
  return RunProcess(argc, argv, spec);
}
