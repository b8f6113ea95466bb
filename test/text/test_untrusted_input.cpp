#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <functional>
#include <thread>

#include "mr_hand_interaction/scene/scene_loader.h"
#include "scene/scene_files.h"
#include "text/files.h"
#include "text/untrusted_input.h"

namespace mrhi {
namespace {

std::string nested(int levels) {
  std::string text;
  for (int i = 0; i < levels; ++i) text = "<a>" + text + "</a>";
  return text;
}

TEST(XmlDanger, elements_are_as_deep_as_32_and_no_deeper) {
  EXPECT_FALSE(xml_danger(nested(32)));
  EXPECT_EQ(xml_danger(nested(33)), "elements are nested deeper than 32 levels; allowed: at most that");
  // What closes itself is no level for what comes after it, and what closes gives its level back.
  std::string beside;
  for (int i = 0; i < 100; ++i) beside += "<b/><c x='1'></c>";
  EXPECT_FALSE(xml_danger("<a>" + beside + nested(31) + nested(31) + "</a>"));
  EXPECT_TRUE(xml_danger("<a>" + beside + nested(32) + "</a>"));
}

TEST(XmlDanger, tags_in_comments_data_instructions_and_quotes_are_none) {
  std::string opened;
  for (int i = 0; i < 40; ++i) opened += "<a>";
  EXPECT_TRUE(xml_danger(opened));
  EXPECT_FALSE(xml_danger("<!-- " + opened + " -->"));
  EXPECT_FALSE(xml_danger("<![CDATA[" + opened + "]]>"));
  EXPECT_FALSE(xml_danger("<a x=\"" + opened + "\" y='" + opened + "'/>"));
  EXPECT_FALSE(xml_danger("<a x=\"'\"/><a y='\"'/>"));
}

// What the library takes for the end of a thing must be what is taken for it here, or something hides behind
// it.
TEST(XmlDanger, nothing_hides_behind_what_ends_sooner_or_later_than_it_seems) {
  const std::string deep = nested(33);
  for (const std::string& before :
       {std::string("<!--><a x=\"-->"), std::string("<!---><a x=\"-->"), std::string("<?xml >"),
        std::string("<?xml version=\"1.0\">"), std::string("<?pi >"), std::string("<1 x=\">"),
        std::string("< x='>"), std::string("<=\">")})
    EXPECT_TRUE(xml_danger(before + deep + "?>")) << before;
  EXPECT_EQ(xml_danger("<a>1 < 2</a>"),
            "has a '<' that begins nothing known; allowed: elements, comments, CDATA and <?xml ...?>");
}

TEST(XmlDanger, what_is_usual_around_a_robot_is_taken) {
  for (const char* usual :
       {"<?xml version=\"1.0\" ?><robot/>", "\xEF\xBB\xBF<?xml version='1.0'?><robot/>",
        "<?xml version=\"1.0\"?><?xml-model href=\"a.xsd\"?><robot/>", "<!----><a/>",
        "<a:b_c x='1' y=\"2\" />", "<\xC3\xBC/>", "<_a></_a>", "<Z/>", "<z/>", "<A/>", ""})
    EXPECT_FALSE(xml_danger(usual)) << usual;
}

TEST(XmlDanger, a_document_type_is_told) {
  EXPECT_EQ(xml_danger("<!DOCTYPE a [<!ENTITY b 'c'>]><a/>"), "has a document type; allowed: none");
  EXPECT_FALSE(xml_danger("<!-- <!DOCTYPE a> --><a/>"));
}

TEST(XmlDanger, elements_are_counted) {
  std::string many;
  for (int i = 0; i < 99'999; ++i) many += "<a/>";
  EXPECT_FALSE(xml_danger("<r>" + many + "</r>"));
  EXPECT_EQ(xml_danger("<r>" + many + "<a/></r>"), "100001 elements; allowed: at most 100000");
}

TEST(XmlDanger, attributes_of_an_element_are_counted) {
  std::string many;
  for (int i = 0; i < 64; ++i) many += " a='=\"='";
  EXPECT_FALSE(xml_danger("<r" + many + "><a b='1'/></r>"));
  EXPECT_EQ(xml_danger("<r><a" + many + " b='1'/></r>"), "an element has 65 attributes; allowed: at most 64");
}

TEST(XmlDanger, text_is_utf8_without_control_characters) {
  // One of each length, at both ends of what each may hold.
  for (const char* good : {"\x7F", "\xC2\x80", "\xDF\xBF", "\xE0\xA0\x80", "\xEF\xBF\xBD", "\xF0\x90\x80\x80",
                           "\xF4\x8F\xBF\xBF", "a\tb\r\nc"})
    EXPECT_FALSE(xml_danger(good)) << good;
  // A continuation alone, an overlong form, a lead that none has, each cut short, and one not continued.
  for (const char* bad : {"\x80", "\xC1\x80", "\xF5\x80\x80\x80", "\xC2", "\xE2\x82", "\xF0\x9F\x98",
                          "\xC2\x41", "\xE2\x82\xC0", "\xE2\x41\x80", "\x01", "\x1B"})
    EXPECT_EQ(xml_danger(bad), "is no text; allowed: UTF-8 or ISO-8859-1 without control characters") << bad;
  EXPECT_TRUE(xml_danger(std::string("a\0b", 3)));
}

TEST(XmlDanger, length_is_bounded) {
  const std::string blanks(kMaxXmlBytes, ' ');
  EXPECT_FALSE(xml_danger(blanks));
  EXPECT_EQ(xml_danger(blanks + ' '), "is longer than 4194304 bytes; allowed: at most that");
}

constexpr ChildLimits kLimits{1, 256u << 20, 1u << 20};

std::string child_error(const ChildLimits& limits, const std::function<std::string()>& work) {
  try {
    run_in_child(limits, work);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(LimitedChild, gives_what_the_work_returns) {
  EXPECT_EQ(run_in_child(kLimits, [] { return std::string(); }), "");
  EXPECT_EQ(run_in_child(kLimits, [] { return std::string("a\0b\n", 4); }), std::string("a\0b\n", 4));
  const std::string longer_than_a_pipe(500'000, 'x');
  EXPECT_EQ(run_in_child(kLimits, [&] { return longer_than_a_pipe; }), longer_than_a_pipe);
}

TEST(LimitedChild, throws_what_the_work_throws) {
  EXPECT_EQ(child_error(kLimits, []() -> std::string { throw std::invalid_argument("no such mesh"); }),
            "no such mesh");
}

TEST(LimitedChild, changes_nothing_here) {
  int here = 1;
  run_in_child(kLimits, [&] {
    here = 2;
    return std::string();
  });
  EXPECT_EQ(here, 1);
}

const char* const kTooMuch = "takes more time or memory than is allowed, or cannot be read";

TEST(LimitedChild, that_ends_or_gives_too_much_is_told) {
  EXPECT_EQ(child_error(kLimits, []() -> std::string { _exit(0); }), kTooMuch);
  EXPECT_EQ(child_error(kLimits,
                        []() -> std::string {
                          raise(SIGKILL);
                          return "";
                        }),
            kTooMuch);
  // A letter of its own says that the work is done.
  const ChildLimits ten{1, 256u << 20, 10};
  EXPECT_EQ(run_in_child(ten, [] { return std::string(9, 'x'); }), std::string(9, 'x'));
  EXPECT_EQ(child_error(ten, [] { return std::string(10, 'x'); }), kTooMuch);
}

TEST(LimitedChild, that_never_ends_is_ended) {
  EXPECT_EQ(child_error(kLimits,
                        []() -> std::string {
                          for (volatile unsigned i = 0;; i = i + 1) {
                          }
                        }),
            kTooMuch);
}

double seconds_of(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

std::string sleep_long() {
  std::this_thread::sleep_for(std::chrono::seconds(60));
  return "";
}

// A pipe or a network's file takes no processor time.
TEST(LimitedChild, that_waits_is_ended_by_the_clock) {
  const ChildLimits short_limits{0.3, 256u << 20, 1u << 20};
  EXPECT_LT(seconds_of([&] { EXPECT_EQ(child_error(short_limits, sleep_long), kTooMuch); }), 5.0);
}

TEST(LimitedChild, ends_once_it_is_cancelled) {
  const ChildLimits long_limits{60, 256u << 20, 1u << 20};
  int asked = 0;
  const double seconds = seconds_of([&] {
    EXPECT_THROW(run_in_child(long_limits, sleep_long, [&] { return ++asked > 2; }), std::runtime_error);
  });
  EXPECT_LT(seconds, 5.0);
}

TEST(FileText, is_as_much_as_is_asked_for) {
  const test::Folder folder;
  const std::string file = folder.write("a", "abc\ndef");
  EXPECT_EQ(file_text(file, 100), "abc\ndef");
  EXPECT_EQ(file_text(file, 7), "abc\ndef");
  EXPECT_EQ(file_text(file, 2), "ab");
  EXPECT_EQ(file_text(folder.write("empty", ""), 10), "");
}

TEST(FileText, is_of_a_regular_file_alone) {
  const test::Folder folder;
  EXPECT_FALSE(file_text(folder.path(), 10));
  EXPECT_FALSE(file_text(folder.path() + "/none", 10));
  EXPECT_FALSE(file_text("/dev/zero", 10));
}

std::string not_found(const std::string& name, const std::vector<std::string>& folders) {
  try {
    return "found " + find_named_file("task", name, ".yaml", folders);
  } catch (const SceneError& error) {
    return error.what();
  }
}

TEST(NamedFile, is_a_path_or_in_the_first_folder_that_has_it) {
  const test::Folder one, other;
  const std::string ours = one.write("carry.yaml", ""), theirs = other.write("carry.yaml", "");
  const std::string only = other.write("tap.yaml", "");
  const std::vector<std::string> folders{one.path(), other.path()};
  EXPECT_EQ(find_named_file("task", "carry", ".yaml", folders), ours);
  EXPECT_EQ(find_named_file("task", "carry", ".yaml", {other.path(), one.path()}), theirs);
  EXPECT_EQ(find_named_file("task", "tap", ".yaml", folders), only);
  EXPECT_EQ(find_named_file("task", theirs, ".yaml", {one.path()}), theirs);
}

TEST(NamedFile, may_have_any_extension_if_the_file_exists) {
  const test::Folder here, folder;
  const std::string known = folder.write("carry.yaml", "");
  const test::WorkingFolder working(here.path());
  for (const std::string name : {"tap_UP.YAML", "tap.yml", "tap", "carry"}) {
    here.write(name, "");
    EXPECT_EQ(find_named_file("task", name, ".yaml", {folder.path()}), name == "carry" ? known : name);
  }
}

TEST(NamedFile, that_is_not_there_is_told_with_those_there_are) {
  const test::Folder one, other;
  one.write("b.yaml", "");
  one.write("no.txt", "");
  std::filesystem::create_directory(one.path() + "/folder.yaml");
  other.write("a.yaml", "");
  other.write("b.yaml", "");
  const std::vector<std::string> folders{one.path(), other.path(), "/nowhere/at/all"};
  const std::string allowed = "; allowed: a YAML file, or one of a, b";
  EXPECT_EQ(not_found("c", folders), "unknown task 'c'" + allowed);
  EXPECT_EQ(not_found("./c", folders), "task file './c' does not exist" + allowed);
  EXPECT_EQ(not_found("c.yaml", folders), "task file 'c.yaml' does not exist" + allowed);
}

std::string message_of(const std::function<void()>& work) {
  try {
    work();
  } catch (const FileError& error) {
    return error.what();
  }
  return "";
}

/// Opening a pipe waits for who is at its other end, and a device may have no end.
TEST(Files, what_is_no_file_is_neither_read_nor_written) {
  const test::Folder folder;
  const std::string pipe = folder.path() + "/pipe", device = folder.path() + "/device";
  ASSERT_EQ(0, mkfifo(pipe.c_str(), 0600));
  std::filesystem::create_symlink("/dev/zero", device);
  for (const std::string& file : {pipe, device, folder.path()}) {
    EXPECT_EQ(why_unreadable(file), "is no file");
    EXPECT_FALSE(file_text(file, 10));
    EXPECT_EQ(message_of([&] { FileLines lines(file); }),
              file + ": is no file; allowed: a file that may be read");
  }
  EXPECT_EQ(why_unreadable(folder.path() + "/none"), "there is no such file");
  EXPECT_EQ(why_unreadable(folder.write("some", "")), "");
  EXPECT_EQ(message_of([&] { file_to_write(pipe); }),
            "cannot write " + pipe + ": it is no file; allowed: a file, or none yet");
  EXPECT_TRUE(file_to_write(folder.path() + "/new"));
  EXPECT_FALSE(file_to_write(folder.path())) << "a folder is for the stream to refuse";
}

TEST(Files, lines_are_those_of_the_text_and_have_a_bound) {
  const test::Folder folder;
  const std::string longest(64 * 1024, 'x');
  const std::string file = folder.write("lines", "one\n\n" + longest + "\nlast");
  FileLines lines(file);
  std::string line;
  std::vector<std::string> all;
  while (lines.next(line)) all.push_back(line);
  EXPECT_EQ(all, (std::vector<std::string>{"one", "", longest, "last"}));
  const std::string beyond = folder.write("beyond", "one\n" + longest + "x\n");
  FileLines too_long(beyond);
  EXPECT_TRUE(too_long.next(line));
  EXPECT_EQ(message_of([&] { too_long.next(line); }),
            beyond + ":2: is longer than 65536 bytes; allowed: at most that");
  FileLines none(folder.write("empty", ""));
  EXPECT_FALSE(none.next(line));
}

}  // namespace
}  // namespace mrhi
