#include "runtime/main.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <optional>
#include <string>

#include "hub/hub.h"
#include "settings/settings.h"

namespace {

using namespace vismap;

struct Arguments {
  std::optional<std::string> listen;
  std::optional<int> queue_mb, socket_buffer_bytes, max_clients;
  std::optional<double> patience;
  PolicyLists lists;
  FaultOptions faults;
  ChannelPolicies policies;
  VismapConfig config;
};

void AddOptions(CLI::App& app, Arguments* arguments) {
  app.add_option(
      "--listen", arguments->listen,
      "Address to listen on, numbers only; port 0 = any free one, printed; default 127.0.0.1:7700");
  app.add_option(
         "--queue-mb", arguments->queue_mb,
         "Megabytes of lossless messages that may wait for a client before publishers wait, "
         "and of others before it loses them; default 256")
      ->check(CLI::Range(1, 65536));
  app.add_option("--socket-buffer-bytes", arguments->socket_buffer_bytes,
                 "Send and receive buffer of each connection; 0 = the system's")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--max-clients", arguments->max_clients,
                 "Connections beyond are refused; default 256")
      ->check(CLI::Range(1, 10000));
  app.add_option("--patience-s", arguments->patience,
                 "A client that takes nothing for so long while publishers wait for it is cut off; "
                 "default 30")
      ->check(CLI::Range(0.1, 60.0));
  app.add_option("--lossless", arguments->lists.lossless,
                 "Channels (regular expressions) whose publishers wait for slow readers")
      ->delimiter(',');
  app.add_option("--latest", arguments->lists.latest,
                 "Channels of which a slow reader gets the latest message only")
      ->delimiter(',');
  app.add_option("--drop-newest", arguments->lists.drop_newest,
                 "Channels of which a slow reader loses the newest messages")
      ->delimiter(',');
  app.add_option("--drop-fraction", arguments->faults.drop_fraction,
                 "For tests: lose this part of the messages on purpose, 0 to 1")
      ->check(CLI::Range(0.0, 1.0));
  app.add_option("--drop-seed", arguments->faults.seed, "For tests: which ones are lost");
  app.add_option("--drop-channels", arguments->faults.channels,
                 "For tests: lose messages of these channels only, NAME,NAME")
      ->delimiter(',');
}

// The command line goes before the config.
Result<std::string> Configure(const std::string& text, const std::string& path,
                              Arguments* arguments) {
  const Result<std::string> taken = TakeConfig(text, path, &arguments->config);
  if (!taken) return taken;
  HubConfig& section = arguments->config.hub;
  section.listen = arguments->listen.value_or(section.listen);
  section.queue_mb = arguments->queue_mb.value_or(section.queue_mb);
  section.socket_buffer_bytes =
      arguments->socket_buffer_bytes.value_or(section.socket_buffer_bytes);
  section.max_clients = arguments->max_clients.value_or(section.max_clients);
  section.patience = arguments->patience.value_or(section.patience);
  const PolicyLists& lists = arguments->lists;
  if (!lists.lossless.empty()) section.lossless = lists.lossless;
  if (!lists.latest.empty()) section.latest = lists.latest;
  if (!lists.drop_newest.empty()) section.drop_newest = lists.drop_newest;
  Result<ChannelPolicies> policies =
      ChannelPolicies::Make({section.lossless, section.latest, section.drop_newest});
  if (!policies) return tl::unexpected(policies.error());
  arguments->policies = std::move(*policies);
  return PrintConfig(arguments->config);
}

std::string Percent(double fraction) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.4g %%", fraction * 100);
  return text;
}

Outcome Serve(const Arguments& arguments, ProcessContext& context) {
  const HubConfig& config = arguments.config.hub;
  const FaultOptions& faults = arguments.faults;
  HubOptions options;
  options.faults = faults;
  options.policies = arguments.policies;
  options.patience = config.patience;
  options.queue_bytes = static_cast<size_t>(config.queue_mb) * kMegabyte;
  options.socket_buffer_bytes = config.socket_buffer_bytes;
  options.max_clients = config.max_clients;
  const Result<TcpAddress> listen = ParseTcpAddress(config.listen);
  if (!listen) return ExitWith(ExitCode::kUsage, "--listen: " + listen.error().message);
  options.listen = *listen;
  if (context.options.name != "hub") options.name = context.options.name;
  const Result<std::unique_ptr<Hub>> hub = Hub::Open(options);
  if (!hub) return ExitWith(ExitCode::kFailed, hub.error().message);
  std::printf("tcpq://%s:%d\n", listen->host.c_str(), (*hub)->port());
  std::fflush(stdout);
  if (faults.drop_fraction > 0) {
    LogWarning("for a test: loses " + Percent(faults.drop_fraction) +
               " of the messages on purpose");
  }
  context.service.Say("running: tcpq://" + listen->host + ":" + std::to_string((*hub)->port()));
  context.service.Ready();
  (*hub)->Run(context.stop, [&] { context.service.Alive(); });
  context.service.Stopping();
  const HubCounters& counters = (*hub)->counters();
  LogInfo("passed on " + std::to_string(counters.received) + " messages, dropped " +
          std::to_string(counters.dropped) +
          (faults.drop_fraction > 0
               ? ", lost on purpose " + std::to_string(counters.dropped_on_purpose)
               : ""));
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
  spec.configure = [&](const std::string& text, const std::string& path) {
    return Configure(text, path, &arguments);
  };
  spec.run = [&](ProcessContext& context) { return Serve(arguments, context); };
  return RunProcess(argc, argv, spec);
}
