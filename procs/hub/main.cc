#include "runtime/main.h"

#include <cstdio>
#include <string>

#include "hub/hub.h"
#include "settings/settings.h"

namespace {

using namespace vismap;

struct Arguments {
  FaultOptions faults;
  ChannelPolicies policies;
  VismapConfig config;
};

void AddOptions(CommandLine& line, HubConfig* config) {
  line.Option("--listen", &config->listen,
              "Address to listen on, numbers only; port 0 = any free one, printed");
  line.Option("--queue-mb", &config->queue_mb,
              "Megabytes of lossless messages that may wait for a client before publishers wait, "
              "and of others before it loses them")
      .Range(1, 65536);
  line.Option("--socket-buffer-bytes", &config->socket_buffer_bytes,
              "Send and receive buffer of each connection; 0 = the system's")
      .AtLeast(0);
  line.Option("--max-clients", &config->max_clients, "Connections beyond are refused")
      .Range(1, 10000);
  line.Option("--patience-s", &config->patience,
              "A client that takes nothing for so long while publishers wait for it is cut off")
      .Range(0.1, 60);
  line.Option("--lossless", &config->lossless,
              "Channels (regular expressions) whose publishers wait for slow readers");
  line.Option("--latest", &config->latest,
              "Channels of which a slow reader gets the latest message only");
  line.Option("--drop-newest", &config->drop_newest,
              "Channels of which a slow reader loses the newest messages");
}

void AddFaults(CommandLine& line, FaultOptions* faults) {
  line.Option("--drop-fraction", &faults->drop_fraction,
              "For tests: lose this part of the messages on purpose")
      .Range(0, 1);
  line.Option("--drop-seed", &faults->seed, "For tests: which ones are lost");
  line.Option("--drop-channels", &faults->channels,
              "For tests: lose messages of these channels only, NAME,NAME");
}

Result<std::string> CheckOptions(Arguments* arguments) {
  const HubConfig& config = arguments->config.hub;
  Result<ChannelPolicies> policies =
      ChannelPolicies::Make({config.lossless, config.latest, config.drop_newest});
  if (!policies) return tl::unexpected(policies.error());
  arguments->policies = std::move(*policies);
  return CheckConfig(arguments->config);
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
  context.service.SetStatus("running: tcpq://" + listen->host + ":" +
                            std::to_string((*hub)->port()));
  context.service.SetReady();
  (*hub)->Run(context.stop, [&] { context.service.KeepAlive(); });
  context.service.SetStopping();
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
  spec.add_options = [&](CommandLine& line) {
    AddOptions(line, &arguments.config.hub);
    AddFaults(line, &arguments.faults);
  };
  UseConfig(&arguments.config, &spec);
  spec.check_config = [&] { return CheckOptions(&arguments); };
  spec.run = [&](ProcessContext& context) { return Serve(arguments, context); };
  return RunProcess(argc, argv, spec);
}
