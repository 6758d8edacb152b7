#include <coxa/pipeline/structures.h>

#include <gtest/gtest.h>

#include <algorithm>

namespace coxa::pipeline {

using Names = std::vector<std::string>;

TEST(Structures, AreNamedByGroupsAndOneByOneOnceEach) {
  EXPECT_EQ(structures_from("bones,femur,sartorius"), (Names{"femur", "hip_bone", "sartorius"}));
  EXPECT_EQ(structures_from("labrum"), Names{"acetabular_labrum"});
  EXPECT_EQ(structures_from("iliofemoral_ligament"),
            (Names{"iliofemoral_ligament_transverse", "iliofemoral_ligament_descending"}));
  EXPECT_EQ(structures_from("ligaments").size(), 6u);
  EXPECT_EQ(structures_from("all").size(), 4u + 26u + 7u);
}
TEST(Structures, OnlyLabrumAndLigamentsAreGeneric) {
  const Names all = structures_from("all");
  EXPECT_EQ(std::count_if(all.begin(), all.end(), is_generic), 7);
  EXPECT_TRUE(is_generic("acetabular_labrum"));
  EXPECT_FALSE(is_generic("acetabular_cartilage"));
}

}  // namespace coxa::pipeline
