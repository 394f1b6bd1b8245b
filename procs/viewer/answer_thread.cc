#include "viewer/answer_thread.h"

#include <string>

#include "runtime/clock.h"
#include "viewer/evidence_answers.h"

namespace vismap {

AnswerThread::AnswerThread() : thread_([this] { Run(); }) {}

AnswerThread::~AnswerThread() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void AnswerThread::Ask(Work work, const WebHandler::Reply& reply) {
  {
    const std::lock_guard lock(mutex_);
    if (waiting_.size() < kMostWaiting) {
      waiting_.push_back({std::move(work), reply, MonotonicSeconds()});
      changed_.notify_all();
      return;
    }
  }
  reply(ErrorAnswer(429, std::to_string(kMostWaiting) + " questions wait already; try again"));
}

void AnswerThread::Poll() {
  std::vector<std::pair<WebHandler::Reply, HttpAnswer>> done;
  {
    const std::lock_guard lock(mutex_);
    done.swap(done_);
  }
  for (auto& [reply, answer] : done) reply(std::move(answer));
}

void AnswerThread::Run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ends_ || !waiting_.empty(); });
    if (ends_) return;
    Question question = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    HttpAnswer answer = AnswerInTurn(question.asked, MonotonicSeconds(), question.work);
    question.work = nullptr;  // what it holds is released by this thread
    lock.lock();
    done_.emplace_back(std::move(question.reply), std::move(answer));
  }
}

}  // namespace vismap
