#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SparseCore>

namespace taut {

using Index = Eigen::Index;
using Vector = Eigen::VectorXd;
using Vector2 = Eigen::Vector2d;
using Vector3 = Eigen::Vector3d;
using Matrix = Eigen::MatrixXd;
using Matrix2 = Eigen::Matrix2d;
using Matrix3 = Eigen::Matrix3d;
using Matrix32 = Eigen::Matrix<double, 3, 2>;
using SparseMatrix = Eigen::SparseMatrix<double>;

}  // namespace taut
