#include "runtime/main.h"

#include <cstdio>
#include <string>

#include "base/format.h"
#include "hub/hub.h"
#include "settings/settings.h"

namespace {

using namespace vismap;

struct Arguments {
  FaultOptions faults;
  VismapConfig config;
};

void AddOptions(CommandLine& line, HubOptions* config) {
  line.Option("--listen", &config->listen,
              "Numeric address and port to listen on; port 0 = choose a free port and print it");
  line.Option(
          "--queue-mb", &config->queue_mb,
          "Size of the queue of each client, in MB, for lossless messages and again for all others")
      .Range(1, 65536);
  line.Option("--socket-buffer-bytes", &config->socket_buffer_bytes,
              "Size of the send and receive buffers of each connection; 0 = system default")
      .AtLeast(0);
  line.Option("--max-clients", &config->max_clients,
              "Largest number of clients; further ones are rejected")
      .Range(1, 10000);
  line.Option("--patience-s", &config->patience_s,
              "A client that reads nothing for this many seconds while publishers wait for it is "
              "disconnected")
      .Range(0.1, 60);
  line.Option("--lossless", &config->lossless,
              "Channels (regular expressions) whose publishers wait for slow readers, so that no "
              "message is lost");
  line.Option(
      "--latest", &config->latest,
      "Channels (regular expressions) of which a slow reader receives only the latest message");
  line.Option("--drop-newest", &config->drop_newest,
              "Channels (regular expressions) of which new messages for a slow reader are dropped");
}

void AddFaults(CommandLine& line, FaultOptions* faults) {
  line.Option("--drop-fraction", &faults->drop_fraction,
              "For tests: share of the messages that the hub loses intentionally")
      .Range(0, 1);
  line.Option("--drop-seed", &faults->seed, "For tests: seed of the choice of lost messages");
  line.Option("--drop-channels", &faults->channels,
              "For tests: lose only messages of these channels: NAME,NAME");
}

Outcome Serve(const Arguments& arguments, ProcessContext& context) {
  const HubOptions& options = arguments.config.hub;
  const FaultOptions& faults = arguments.faults;
  const std::string name = context.options.name == "hub" ? "" : context.options.name;
  const Result<std::unique_ptr<Hub>> hub =
      Hub::Open(options, name, faults, context.options.channel_prefix);
  if (!hub) return ExitWith(ExitCode::kFailed, hub.error().message);
  const std::string url =
      "tcpq://" + ParseTcpAddress(options.listen)->host + ":" + std::to_string((*hub)->port());
  std::printf("%s\n", url.c_str());
  std::fflush(stdout);
  if (faults.drop_fraction > 0) {
    LogWarning("this hub is for a test: it loses " + FormatPercent(faults.drop_fraction) +
               " of the messages intentionally");
  }
  context.service.SetStatus("running: " + url);
  context.service.SetReady();
  (*hub)->Run(context.stop, [&] { context.service.KeepAlive(); });
  context.service.SetStopping();
  const HubCounters& counters = (*hub)->counters();
  LogInfo("forwarded " + FormatCount(counters.received, "message") + ", dropped " +
          FormatCount(counters.dropped) +
          (faults.drop_fraction > 0
               ? ", lost intentionally " + FormatCount(counters.dropped_on_purpose)
               : ""));
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  ProcessSpec spec;
  spec.name = "hub";
  spec.summary =
      "Forwards messages between the processes of a bus over TCP, with LCM's tcpq protocol.";
  spec.joins_bus = false;
  spec.add_options = [&](CommandLine& line) {
    AddOptions(line, &arguments.config.hub);
    AddFaults(line, &arguments.faults);
  };
  UseConfig(&arguments.config, &spec, [&] { return CheckOptions(arguments.config.hub); });
  spec.run = [&](ProcessContext& context) { return Serve(arguments, context); };
  return RunProcess(argc, argv, spec);
}
