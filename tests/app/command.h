#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

/// The command as a user meets it: run in a process of its own, judged by exit code and output.
namespace coxa::test {

struct Outcome {
  int exit_code = -1;
  std::string output;  ///< standard output and error together

  bool says(const std::string& text) const { return output.find(text) != std::string::npos; }
};

inline Outcome run_shell(const std::string& command) {
  Outcome outcome;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  std::array<char, 4096> buffer;
  while (const std::size_t n = fread(buffer.data(), 1, buffer.size(), pipe))
    outcome.output.append(buffer.data(), n);
  outcome.exit_code = WEXITSTATUS(pclose(pipe));
  return outcome;
}

inline Outcome coxa_run(const std::string& arguments) {
  return run_shell(std::string(COXA_BINARY) + " " + arguments);
}

/// Runs the command with --json and sends it Ctrl-C as soon as its output holds `sign`.
inline Outcome coxa_interrupted(std::vector<std::string> arguments,
                                const std::string& sign = "\"progress\"") {
  arguments.insert(arguments.begin(), COXA_BINARY);
  arguments.push_back("--json");
  std::vector<char*> words;
  for (std::string& word : arguments) words.push_back(word.data());
  words.push_back(nullptr);
  int ends[2] = {-1, -1};
  if (pipe(ends) != 0) return {};
  const pid_t child = fork();
  if (child == 0) {
    dup2(ends[1], STDOUT_FILENO);
    dup2(ends[1], STDERR_FILENO);
    close(ends[0]);
    execv(words[0], words.data());
    _exit(127);
  }
  close(ends[1]);
  Outcome outcome;
  bool sent = false;
  std::array<char, 4096> buffer;
  for (ssize_t n = 0; (n = read(ends[0], buffer.data(), buffer.size())) > 0;) {
    outcome.output.append(buffer.data(), static_cast<std::size_t>(n));
    if (!sent && outcome.says(sign)) {
      kill(child, SIGINT);
      sent = true;
    }
  }
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return outcome;
}

/// A test with a folder of its own, removed with everything in it.
class CommandTest : public ::testing::Test {
 protected:
  CommandTest()
      : folder_(std::filesystem::temp_directory_path() /
                ("coxa_command_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~CommandTest() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  /// True while nothing by this name, nor a half-written one, lies in the test's folder.
  bool nothing_at(const std::string& name) const {
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
      const std::string there = entry.path().filename().string();
      if (there.starts_with(name) || there.find(".partial") != std::string::npos) return false;
    }
    return true;
  }
  std::filesystem::path folder_;
};

}  // namespace coxa::test
