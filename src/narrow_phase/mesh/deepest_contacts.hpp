// DeepestContacts: the contacts of a pair that a result keeps.
//
// Order     By descending depth, then by the numbers of the triangles of a and b.
// Memory    At most `most` contacts, the first ones in this order, however many a pair has.
#pragma once

#include <algorithm>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include "octopair/collision.hpp"

namespace octopair {

class DeepestContacts {
public:
    explicit DeepestContacts(std::uint32_t most) : most_(most) {}

    void add(const Contact& contact) {
        if (heap_.size() == most_) {
            more_ = true;
            if (heap_.empty() || !comes_first(contact, heap_.front())) return;
            std::pop_heap(heap_.begin(), heap_.end(), comes_first);
            heap_.pop_back();
        }
        heap_.push_back(contact);
        std::push_heap(heap_.begin(), heap_.end(), comes_first);
    }

    /// Moves the contacts to `finding`, in order.
    void give(Finding& finding) {
        std::sort_heap(heap_.begin(), heap_.end(), comes_first);
        finding.more_contacts = more_;
        finding.contacts = std::move(heap_);
    }

private:
    static bool comes_first(const Contact& a, const Contact& b) {
        return std::tuple(-a.depth, a.feature_a, a.feature_b) < std::tuple(-b.depth, b.feature_a, b.feature_b);
    }

    std::uint32_t most_;
    bool more_ = false;
    std::vector<Contact> heap_;  // its front is the last contact in order
};

}  // namespace octopair
