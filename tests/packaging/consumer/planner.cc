// A program outside vismap: prints why there is no free space on the bus whose URL is its argument.
#include <vismap/navigation.h>

#include <iostream>

int main(int, char** argv) {
  vismap::NavigationClientOptions options;
  options.url = argv[1];
  vismap::NavigationClient navigation(options);
  navigation.Start();
  const vismap::FreeSpace space = navigation.WaitFor(vismap::TreeKind::kClosed, 0.5);
  std::cout << (space ? "a tree" : space.why) << "\n";
}
