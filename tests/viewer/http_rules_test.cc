#include "viewer/http_rules.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "support/temp_folder.h"

namespace vismap {
namespace {

using testing::HasSubstr;

TEST(HttpRules, HostMustBeANameOfThisComputer) {
  const std::vector<std::string> hosts = {"Viewer.Example"};
  for (const char* host : {"127.0.0.1:8080", "10.0.0.7", "[::1]:8080", "localhost", "LOCALHOST:1",
                           "robot7:8080", "robot7.local", "viewer.example:80", "robot7.local.:1"})
    EXPECT_TRUE(CheckHost(host, "Robot7", hosts)) << host;
  for (const char* host : {"", "evil.example", "evil.example:8080", "robot7.evil.example", "[::1",
                           "127.0.0.1.evil.example:8080", "localhost.evil.example", ":8080"})
    EXPECT_FALSE(CheckHost(host, "Robot7", hosts)) << host;
  EXPECT_FALSE(CheckHost("", "", {}));
  EXPECT_FALSE(CheckHost(".local", "", {}));
  EXPECT_THAT(CheckHost("evil.example", "r", {}).error().message, HasSubstr("viewer.hosts"));
}

TEST(HttpRules, OriginMustBeTheHost) {
  EXPECT_TRUE(CheckOrigin(std::nullopt, "127.0.0.1:8080"));
  EXPECT_TRUE(CheckOrigin("http://127.0.0.1:8080", "127.0.0.1:8080"));
  EXPECT_TRUE(CheckOrigin("https://Robot:8080", "robot:8080"));
  for (const char* origin : {"", "null", "http://127.0.0.1:8081", "http://evil.example",
                             "http://127.0.0.1:8080.evil.example", "127.0.0.1:8080"})
    EXPECT_FALSE(CheckOrigin(origin, "127.0.0.1:8080")) << origin;
}

TEST(HttpRules, PagesOfOtherSitesAreRefused) {
  for (const char* site : {"", "none", "same-origin"})
    EXPECT_TRUE(CheckSite(site, std::nullopt, "robot:8080")) << site;
  for (const char* site : {"cross-site", "same-site", "Cross-Site"})
    EXPECT_FALSE(CheckSite(site, std::nullopt, "robot:8080")) << site;
  EXPECT_FALSE(CheckSite("", "http://evil.example", "robot:8080"));
}

TEST(HttpRules, TargetIsTakenApart) {
  const auto target = ParseTarget("/api/slice?axis=z&at=1.0&&name=a%20b+c&empty");
  ASSERT_TRUE(target);
  EXPECT_EQ(target->path, "/api/slice");
  EXPECT_EQ(target->query.at("axis"), "z");
  EXPECT_EQ(target->query.at("name"), "a b c");
  EXPECT_EQ(target->query.at("empty"), "");
  EXPECT_EQ(ParseTarget("/%2e%2e/x")->path, "/../x");
}

TEST(HttpRules, WrongTargetsAreRefused) {
  std::string many = "/?";
  for (int i = 0; i < 17; ++i) many += "k" + std::to_string(i) + "=1&";
  for (const std::string& target :
       {std::string(""), std::string("x"), std::string("http://a/"), std::string("/%"),
        std::string("/%1"), std::string("/%zz"), std::string("/%00"), std::string("/a%0ab"),
        std::string("/?a=1&a=2"), std::string("/\x01"), many})
    EXPECT_FALSE(ParseTarget(target)) << target;
}

class PageFolder : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_.path() / "page" / "deep");
    Write("page/index.html", "<p>");
    Write("page/app.js", "1");
    Write("page/deep/style.css", "a{}");
    Write("page/.hidden", "no");
    Write("secret.txt", "no");
    std::filesystem::create_symlink(folder_.path() / "secret.txt",
                                    folder_.path() / "page/link.txt");
    std::filesystem::create_symlink(folder_.path() / "page/app.js",
                                    folder_.path() / "page/inner.js");
  }
  void Write(const std::string& name, const std::string& text) {
    std::ofstream(folder_.path() / name) << text;
  }
  HttpAnswer Get(const std::string& path) {
    return ReadPageFile((folder_.path() / "page").string(), path);
  }
  TempFolder folder_;
};

TEST_F(PageFolder, FilesComeWithTheirTypes) {
  EXPECT_EQ(Get("/").content_type, "text/html; charset=utf-8");
  EXPECT_EQ(Get("/index.html").body, std::vector<uint8_t>({'<', 'p', '>'}));
  EXPECT_EQ(Get("/app.js").content_type, "text/javascript; charset=utf-8");
  EXPECT_EQ(Get("/inner.js").status, 200);
  EXPECT_EQ(Get("/deep/style.css").content_type, "text/css; charset=utf-8");
}

TEST_F(PageFolder, NothingElseCanBeRead) {
  for (const char* path :
       {"/../secret.txt", "/deep/../../secret.txt", "/.hidden", "/./app.js", "/link.txt", "/deep",
        "/deep/", "//etc/passwd", "/app.js/", "/nothing.js", "/a b", "/app.js\\", "/deep/..",
        "app.js", "/etc/passwd", ""})
    EXPECT_EQ(Get(path).status, 404) << path;
}

TEST(MissingPage, SaysHowToBuildIt) {
  const HttpAnswer answer = ReadPageFile("/no/such/folder", "/");
  EXPECT_EQ(answer.status, 200);
  EXPECT_THAT(std::string(answer.body.begin(), answer.body.end()), HasSubstr("scripts/page"));
  EXPECT_EQ(ReadPageFile("/no/such/folder", "/app.js").status, 404);
}

}  // namespace
}  // namespace vismap
