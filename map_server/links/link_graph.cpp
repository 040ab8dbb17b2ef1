// SPDX-License-Identifier: BSD-3-Clause
#include "map_server/links/link_graph.h"

#include <algorithm>

namespace rumi::map_server {

std::vector<const LinkEdge*> LinkGraph::edges() const {
  std::vector<const LinkEdge*> edges;
  for (const auto& [keys, pair] : compared)
    if (pair.edge && pair.edge->link.accepted()) edges.push_back(&*pair.edge);
  for (const LinkEdge& edge : places.found) edges.push_back(&edge);
  return edges;
}

std::vector<Link> LinkGraph::links() const {
  std::vector<Link> links;
  for (const auto& [keys, pair] : compared)
    if (pair.edge) links.push_back(pair.edge->link);
  std::map<SubmapPair, Link> by_appearance = places.refused;
  for (const LinkEdge& edge : places.found) {
    Link& best = by_appearance[std::minmax(edge.link.a, edge.link.b)];
    if (!best.accepted() || best.landmark_inliers < edge.link.landmark_inliers) best = edge.link;
  }
  for (const auto& [keys, link] : by_appearance) links.push_back(link);
  return links;
}

Groups LinkGraph::tied() const {
  Groups groups;
  for (const LinkEdge* edge : edges()) groups.unite(edge->link.a, edge->link.b);
  return groups;
}

Groups LinkGraph::groups() const {
  Groups groups = tied();
  for (const auto& [a, b] : tied_before) groups.unite(a, b);
  return groups;
}

bool LinkGraph::is_only(const LinkEdge& edge, const Submaps& submaps) const {
  Groups others;
  for (const LinkEdge* other : edges())
    if (other != &edge && submaps.contains(other->link.a) && submaps.contains(other->link.b))
      others.unite(other->link.a, other->link.b);
  return others.find(edge.link.a) != others.find(edge.link.b);
}

std::vector<const LinkEdge*> LinkGraph::placing_order(std::set<SubmapKey> placed,
                                                      const std::set<SubmapKey>& members) const {
  const std::vector<const LinkEdge*> all = edges();
  std::vector<const LinkEdge*> order;
  for (;;) {
    const LinkEdge* best = nullptr;
    for (const LinkEdge* edge : all)
      if (members.contains(edge->link.a) && members.contains(edge->link.b) &&
          placed.contains(edge->link.a) != placed.contains(edge->link.b) &&
          (!best || edge->link.landmark_inliers > best->link.landmark_inliers))
        best = edge;
    if (!best) return order;
    order.push_back(best);
    placed.insert({best->link.a, best->link.b});
  }
}

SubmapPairs LinkGraph::contacts() const {
  SubmapPairs contacts = built.touching;
  for (const LinkEdge* edge : edges()) contacts.insert(std::minmax(edge->link.a, edge->link.b));
  return contacts;
}

bool LinkGraph::are_joined(const ImageId& a, const ImageId& b) const {
  return std::binary_search(built.similar.begin(), built.similar.end(), std::pair<ImageId, ImageId>(std::minmax(a, b)));
}

const LinkEdge* LinkGraph::edge_between(SubmapKey a, SubmapKey b) const {
  const auto pair = compared.find(std::minmax(a, b));
  return pair != compared.end() && pair->second.edge ? &*pair->second.edge : nullptr;
}

void LinkGraph::refuse(const std::map<const LinkEdge*, std::string>& doubts) {
  for (auto& [keys, pair] : compared) {
    const auto doubt = pair.edge ? doubts.find(&*pair.edge) : doubts.end();
    if (doubt == doubts.end()) continue;
    pair.edge->link.doubt = doubt->second;
    pair.edge->joints.clear();
  }
  for (auto edge = places.found.end();
       edge != places.found.begin();) {  // backwards, so that pointers to earlier edges stay valid
    const auto doubt = doubts.find(&*--edge);
    if (doubt == doubts.end()) continue;
    Link link = edge->link;
    link.doubt = doubt->second;
    places.refused[std::minmax(link.a, link.b)] = link;
    edge = places.found.erase(edge);
  }
}

void LinkGraph::forget_joints(const LinkEdge& edge, const std::set<JointName>& joints) {
  std::erase_if(compared.at({edge.link.a, edge.link.b}).edge->joints,
                [&](const KeyframeJoint& joint) { return joints.contains(name_of(joint)); });
}

void LinkGraph::take_as_compared(SubmapKey submap, int64_t revision) {
  for (auto& [keys, pair] : compared) {
    if (keys.first == submap && pair.revision_a == revision - 1) pair.revision_a = revision;
    if (keys.second == submap && pair.revision_b == revision - 1) pair.revision_b = revision;
  }
}

}  // namespace rumi::map_server
