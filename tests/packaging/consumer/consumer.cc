// A program outside vismap: prints which process was the first to publish on the bus whose URL is
// its argument.
#include <iostream>
#include <lcm/lcm-cpp.hpp>
#include <vismap/process_status_t.hpp>

struct Listener {
  void OnStatus(const lcm::ReceiveBuffer*, const std::string&,
                const vismap::process_status_t* status) {
    std::cout << status->process << " " << status->version << "\n";
  }
};

int main(int, char** argv) {
  lcm::LCM bus(argv[1]);
  if (!bus.good()) return 1;
  Listener listener;
  bus.subscribe("STATUS", &Listener::OnStatus, &listener);
  return bus.handle();
}
