#include "scene/pair_history.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "base/growing_array.hpp"
#include "base/test_hooks.hpp"
#include "base/tuning.hpp"
#include "octopair/error.hpp"

namespace octopair {

namespace {

/// Iterates over the pairs of a list.
class Reader {
public:
    explicit Reader(const PairList& list) : chunks_(list.chunks()) { next_chunk(); }

    bool done() const { return at_ == end_; }
    const Pair& pair() const { return *at_; }
    void next() { skip(1); }
    /// Returns the pairs of this chunk that are left.
    std::span<const Pair> rest() const { return {at_, end_}; }
    /// Advances by some of the pairs of rest().
    void skip(std::size_t pairs) {
        at_ += pairs;
        if (at_ == end_) next_chunk();
    }
    /// Returns the next pairs of this chunk whose keys are less than `key`, and advances beyond these pairs.
    std::span<const Pair> run_before(std::uint64_t key) {
        // Galloping search, because runs are short where much has changed.
        const Pair* const begin = at_;
        std::ptrdiff_t step = 1;
        while (step < end_ - at_ && key_of(at_[step]) < key) step *= 2;
        const Pair* const found = std::partition_point(at_, at_ + std::min(step, end_ - at_),
                                                       [&](const Pair& pair) { return key_of(pair) < key; });
        at_ = found;
        if (at_ == end_) next_chunk();
        return {begin, found};
    }

private:
    void next_chunk() {
        while (!chunks_.empty() && chunks_.front().empty()) chunks_ = chunks_.subspan(1);
        if (chunks_.empty()) {
            at_ = end_ = nullptr;
            return;
        }
        at_ = chunks_.front().data();
        end_ = at_ + chunks_.front().size();
        chunks_ = chunks_.subspan(1);
    }

    std::span<const std::span<const Pair>> chunks_;
    const Pair* at_ = nullptr;
    const Pair* end_ = nullptr;
};

/// Fills a list block by block, and reuses its memory.
class Writer {
public:
    explicit Writer(PairList& list) : storage_(detail::storage_of(list)) { storage_.reset(); }

    void add(std::span<const Pair> pairs) {
        while (!pairs.empty()) {
            if (used_ == block_.size()) next_block();
            const std::size_t some = std::min(pairs.size(), block_.size() - used_);
            std::copy_n(pairs.begin(), some, block_.begin() + std::ptrdiff_t(used_));
            used_ += some;
            pairs = pairs.subspan(some);
        }
    }
    void add(const Pair& pair) { add(std::span(&pair, 1)); }
    void finish() { storage_.append(block_.first(used_)); }

private:
    void next_block() {
        finish();
        block_ = storage_.take_block(1);
        used_ = 0;
    }

    detail::PairStorage& storage_;
    std::span<Pair> block_;
    std::size_t used_ = 0;
};

/// Removes common keys from two ascending lists. Each occurrence in one list removes one occurrence in the other.
void cancel(std::vector<std::uint64_t>& first, std::vector<std::uint64_t>& second) {
    auto a = first.begin(), b = second.begin();
    auto a_out = a, b_out = b;
    while (a != first.end() && b != second.end()) {
        if (*a < *b) {
            *a_out++ = *a++;
        } else if (*b < *a) {
            *b_out++ = *b++;
        } else {
            ++a, ++b;
        }
    }
    first.erase(std::copy(a, first.end(), a_out), first.end());
    second.erase(std::copy(b, second.end(), b_out), second.end());
}

std::string name_of(std::uint64_t key) {
    const Pair pair = pair_of(key);
    return "pair " + std::to_string(pair.a) + "-" + std::to_string(pair.b);
}

Error wrong_step(const std::string& what) {
    return {ErrorCode::engine_failed,
            "scene step: " + what + "; nothing was changed, and the next step will search all objects"};
}

/// Returns the error for a key that is not greater than the key before it in a list.
Error out_of_order(const std::string& list, std::uint64_t before, std::uint64_t key) {
    const std::string listed = list + " lists " + name_of(key);
    return wrong_step(key == before ? listed + " twice" : listed + " after " + name_of(before));
}

void check_ascending(const char* list, std::span<const Pair> pairs) {
    const auto wrong = std::adjacent_find(pairs.begin(), pairs.end(),
                                          [](const Pair& a, const Pair& b) { return key_of(b) <= key_of(a); });
    if (wrong != pairs.end()) throw out_of_order(list, key_of(wrong[0]), key_of(wrong[1]));
}

/// Checks that the pairs of a full detection ascend.
class AscendingCheck {
public:
    /// Throws: Error{engine_failed} if `pair` does not follow the pair before it.
    void follow(const Pair& pair) {
        const std::uint64_t key = key_of(pair);
        if (key <= before_) throw out_of_order("full detection", before_, key);
        before_ = key;
    }
    /// `pair`: the last of some pairs that are known to ascend.
    void skip_to(const Pair& pair) { before_ = key_of(pair); }

private:
    std::uint64_t before_ = 0;  // no pair has the key 0: its objects would be the same
};

/// Returns the number of pairs with which both spans begin.
std::size_t common_begin(std::span<const Pair> first, std::span<const Pair> second) {
    const std::size_t most = std::min(first.size(), second.size());
    std::size_t i = 0;
    while (i < most && key_of(first[i]) == key_of(second[i])) ++i;
    return i;
}

/// Iterates over ascending keys.
class KeyReader {
public:
    explicit KeyReader(std::span<const std::uint64_t> keys) : keys_(keys) {}

    /// Returns the current key; at the end, a key that is greater than all pairs.
    std::uint64_t key() const { return keys_.empty() ? ~std::uint64_t(0) : keys_.front(); }
    /// Advances to the next different key. Returns whether the current key occurred exactly once.
    bool next() {
        const auto other = std::find_if(keys_.begin(), keys_.end(), [&](std::uint64_t one) { return one != key(); });
        const auto times = other - keys_.begin();
        keys_ = keys_.subspan(std::size_t(times));
        return times == 1;
    }

private:
    std::span<const std::uint64_t> keys_;
};

}  // namespace

PairHistory::PairHistory(Room room) : room_(std::move(room)) {
    detail::storage_of(list_).ask(room_);
    detail::storage_of(other_).ask(room_);
}

void PairHistory::note(std::vector<Pair>& changes, const Pair& pair) const {
    if (changes.size() == changes.capacity()) {
        const std::size_t more = std::max<std::size_t>(changes.size(), 64);
        if (room_) room_(more * sizeof(Pair));
        changes.reserve(changes.size() + more);
    }
    changes.push_back(pair);
}

void PairHistory::take_over(PairChanges& changes) {
    changes.clear();
    Reader before(list_), after(other_);
    AscendingCheck check;
    const auto began = [&] {
        check.follow(after.pair());
        note(changes.began, after.pair());
        after.next();
    };
    while (!before.done() && !after.done()) {
        if (const std::size_t same = common_begin(before.rest(), after.rest()); same > 0) {
            check.follow(after.pair());
            check.skip_to(after.rest()[same - 1]);  // the pairs of the list ascend
            before.skip(same);
            after.skip(same);
        } else if (key_of(before.pair()) < key_of(after.pair())) {
            note(changes.ended, before.pair());
            before.next();
        } else {
            began();
        }
    }
    for (; !before.done(); before.next()) note(changes.ended, before.pair());
    while (!after.done()) began();
    std::swap(list_, other_);
    other_reserved_ = false;
    size_ = list_.size();
    inconsistency_.clear();
}

void PairHistory::prepare(bool little) {
    const std::uint64_t waiting = began_.size() + ended_.size();
    if (waiting > std::max(tuning().scene.min_waiting, size_ / tuning().scene.waiting_part)) {
        count_path(Path::pairs_merged);
        merge();
    } else if (waiting > 0) {
        count_path(Path::pairs_waited);
    }
    if (little && !other_reserved_) reserve_other();
}

/// Fills other_ with a copy of the list, so that a later merge() finds its memory allocated and no later step waits for page faults.
void PairHistory::reserve_other() {
    Writer writer(other_);
    for (Reader reader(list_); !reader.done();) writer.add(reader.run_before(~std::uint64_t(0)));
    writer.finish();
    other_reserved_ = true;
}

void PairHistory::apply(const PairChanges& changes) {
    check_ascending("the search for pairs that began", changes.began);
    check_ascending("the search for pairs that ended", changes.ended);
    if (changes.ended.size() > size_) {
        throw wrong_step(std::to_string(changes.ended.size()) + " pairs ended, the first of them " +
                         name_of(key_of(changes.ended.front())) + ", but the scene had " + std::to_string(size_));
    }
    reserve_more(began_, changes.began.size());
    reserve_more(ended_, changes.ended.size());
    for (const Pair& pair : changes.began) began_.push_back(key_of(pair));
    for (const Pair& pair : changes.ended) ended_.push_back(key_of(pair));
    size_ += changes.began.size();
    size_ -= changes.ended.size();
}

const PairList& PairHistory::list() {
    merge();
    if (is_inconsistent()) throw Error(ErrorCode::engine_failed, inconsistency_);
    return list_;
}

void PairHistory::report_inconsistency(std::uint64_t key, const char* what) {
    if (is_inconsistent()) return;
    inconsistency_ =
        "scene: " + name_of(key) + " " + what + "; the next step will search all objects and list their pairs anew";
}

void PairHistory::merge() {
    if (began_.empty() && ended_.empty()) return;
    for (auto* const keys : {&began_, &ended_}) {
        const auto unsorted = sort_.take(keys->size());
        std::copy(keys->begin(), keys->end(), unsorted.begin());
        const auto sorted = sort_.sort(0, 64);
        std::copy(sorted.begin(), sorted.end(), keys->begin());
    }
    cancel(began_, ended_);
    write_merged();
    std::swap(list_, other_);
    began_.clear();
    ended_.clear();
    size_ = list_.size();
    if (is_inconsistent()) throw Error(ErrorCode::engine_failed, inconsistency_);
}

/// Writes the list with all collected changes to other_. Skips a change that contradicts the list, and reports it in
/// inconsistency_.
void PairHistory::write_merged() {
    Reader reader(list_);
    Writer writer(other_);
    KeyReader began(began_), ended(ended_);  // no key is in both
    while (true) {
        const std::uint64_t key = std::min(began.key(), ended.key());
        while (!reader.done() && key_of(reader.pair()) < key) writer.add(reader.run_before(key));
        if (key == ~std::uint64_t(0)) break;
        const bool listed = !reader.done() && key_of(reader.pair()) == key;
        if (began.key() == key) {
            if (listed) report_inconsistency(key, "began, but was in the list already");
            if (!listed) writer.add(pair_of(key));
            if (!began.next()) report_inconsistency(key, "began twice");
        } else {
            if (listed) reader.next();
            if (!listed) report_inconsistency(key, "ended, but was not in the list");
            if (!ended.next()) report_inconsistency(key, "ended twice");
        }
    }
    writer.finish();
}

void subtract(const PairList& all, std::span<const Pair> less, PairList& out) {
    Reader reader(all);
    Writer writer(out);
    for (const Pair& pair : less) {
        while (key_of(reader.pair()) < key_of(pair)) writer.add(reader.run_before(key_of(pair)));
        reader.next();
    }
    while (!reader.done()) writer.add(reader.run_before(~std::uint64_t(0)));
    writer.finish();
}

}  // namespace octopair
