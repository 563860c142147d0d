// MonotonePieces: keeps the open pieces of a sweep, and cuts triangles off them.
#include "io/meshes/faces/outline_sweep.hpp"

namespace octopair::io {

std::uint32_t MonotonePieces::add_piece(Piece piece) {
    if (closed_.empty()) {
        pieces_.push_back(std::move(piece));
        return std::uint32_t(pieces_.size() - 1);
    }
    const std::uint32_t number = closed_.back();
    closed_.pop_back();
    pieces_[number] = std::move(piece);
    return number;
}

/// Cuts off the triangle of three nodes, from left to right. `side`: the side of the outer nodes on which the second node is.
void MonotonePieces::cut(Side side, std::uint32_t first, std::uint32_t second, std::uint32_t third) {
    if (side == Side::lower) {
        triangles_.push_back({first, second, third});
    } else {
        triangles_.push_back({first, third, second});
    }
}

/// Cuts off the triangles between the node and each edge of the piece's chain.
void MonotonePieces::cut_fan(const Piece& piece, std::uint32_t node) {
    for (std::size_t i = 1; i < piece.chain.size(); ++i) cut(piece.side, piece.chain[i - 1], piece.chain[i], node);
}

void MonotonePieces::extend_piece(std::uint32_t number, std::uint32_t node, Side side) {
    Piece& piece = pieces_[number];
    std::vector<std::uint32_t>& chain = piece.chain;
    if (chain.size() > 1 && side != piece.side) {
        cut_fan(piece, node);
        chain = {chain.back(), node};
    } else {
        const int bulge = side == Side::lower ? 1 : -1;
        while (chain.size() > 1 && outline_.side(chain[chain.size() - 2], chain.back(), node) == bulge) {
            cut(side, chain[chain.size() - 2], chain.back(), node);
            chain.pop_back();
        }
        chain.push_back(node);
    }
    piece.side = side;
}

void MonotonePieces::close_piece(std::uint32_t number, std::uint32_t node) {
    cut_fan(pieces_[number], node);
    pieces_[number] = {};
    closed_.push_back(number);
}

MonotonePieces::Gap MonotonePieces::open(std::uint32_t node) { return {add_piece({{node}, Side::lower}), none}; }

void MonotonePieces::close(const Gap& gap, std::uint32_t node) {
    close_piece(gap.lower, node);
    if (gap.upper != none) close_piece(gap.upper, node);
}

MonotonePieces::Gap MonotonePieces::extend(const Gap& gap, std::uint32_t node, Side side) {
    std::uint32_t left = gap.lower;
    if (gap.upper != none) {
        // The piece next to the edge that ended gets a last edge, from its last node to this node, and is closed.
        close_piece(side == Side::lower ? gap.lower : gap.upper, node);
        if (side == Side::lower) left = gap.upper;
    }
    extend_piece(left, node, side);
    return {left, none};
}

std::pair<MonotonePieces::Gap, MonotonePieces::Gap> MonotonePieces::split(const Gap& gap, std::uint32_t node) {
    if (gap.upper != none) {
        extend_piece(gap.lower, node, Side::upper);
        extend_piece(gap.upper, node, Side::lower);
        return {{gap.lower, none}, {gap.upper, none}};
    }
    // An edge from the last node of the chain to this node divides the piece.
    const auto [last, side] = std::pair(pieces_[gap.lower].chain.back(), pieces_[gap.lower].side);
    extend_piece(gap.lower, node, side);
    const Side other = side == Side::lower ? Side::upper : Side::lower;
    const Gap fresh = {add_piece({{last, node}, other}), none};
    return side == Side::lower ? std::pair(fresh, gap) : std::pair(gap, fresh);
}

}  // namespace octopair::io
