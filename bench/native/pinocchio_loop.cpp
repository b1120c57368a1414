// Pinocchio's algorithms in a loop over configurations, as a user of the C++ library writes it.
// The model comes from the numbers of bench/plain_arm.py; arrays are row-major, one configuration per row.
#include <pinocchio/multibody.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/algorithm/frames.hpp>

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Transform = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
using Tensor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

struct Arm {
    pinocchio::Model model;
    pinocchio::Data data;
    pinocchio::FrameIndex end;
    Eigen::VectorXd q, qd, qdd;
    pinocchio::Data::Matrix6x jacobian;
};

static pinocchio::SE3 placed(const double *rows) {
    const Eigen::Map<const Transform> t(rows);
    return pinocchio::SE3(t.topLeftCorner<3, 3>(), t.topRightCorner<3, 1>());
}

#define EXPORT extern "C" __attribute__((visibility("default")))

using pinocchio::JointIndex;

template <class Kind> static JointIndex add(pinocchio::Model &model, JointIndex parent, const pinocchio::SE3 &at) {
    return model.addJoint(parent, Kind(), at, "q" + std::to_string(model.njoints));
}

static JointIndex (*const kinds_of_joints[])(pinocchio::Model &, JointIndex, const pinocchio::SE3 &) = {
    add<pinocchio::JointModelRX>, add<pinocchio::JointModelRY>, add<pinocchio::JointModelRZ>,
    add<pinocchio::JointModelPX>, add<pinocchio::JointModelPY>, add<pinocchio::JointModelPZ>};

EXPORT void *make_arm(int n, const int *kinds, const int *parents, const double *placements, const double *masses,
                      const double *coms, const double *inertias, const double *end, const double *gravity) {
    Arm *arm = new Arm();
    JointIndex joint = 0;
    arm->model.gravity.linear() = Eigen::Map<const Eigen::Vector3d>(gravity);
    for (int i = 0; i < n; ++i) {
        joint = kinds_of_joints[kinds[i]](arm->model, parents[i], placed(placements + 16 * i));
        const Eigen::Matrix3d tensor = Eigen::Map<const Tensor>(inertias + 9 * i);
        const Eigen::Vector3d com = Eigen::Map<const Eigen::Vector3d>(coms + 3 * i);
        arm->model.appendBodyToJoint(joint, pinocchio::Inertia(masses[i], com, tensor), pinocchio::SE3::Identity());
    }
    arm->end = arm->model.addFrame(pinocchio::Frame("end", joint, 0, placed(end), pinocchio::OP_FRAME));
    arm->data = pinocchio::Data(arm->model);
    arm->q = arm->qd = arm->qdd = Eigen::VectorXd::Zero(n);
    arm->jacobian = pinocchio::Data::Matrix6x::Zero(6, n);
    return arm;
}

EXPORT void free_arm(void *arm) { delete static_cast<Arm *>(arm); }

#define LOOP(NAME, SIZE, LINES)                                                                                      \
    EXPORT void loop_##NAME(void *handle, long count, const double *q, const double *qd, const double *qdd,         \
                            double *out) {                                                                           \
        Arm &arm = *static_cast<Arm *>(handle);                                                                      \
        const long n = arm.model.nv;                                                                                 \
        (void)qd, (void)qdd;                                                                                         \
        for (long k = 0; k < count; ++k, out += (SIZE)) {                                                            \
            arm.q = Eigen::Map<const Eigen::VectorXd>(q + k * n, n);                                                 \
            LINES                                                                                                    \
        }                                                                                                            \
    }
#define VELOCITY arm.qd = Eigen::Map<const Eigen::VectorXd>(qd + k * n, n);
#define ACCELERATION arm.qdd = Eigen::Map<const Eigen::VectorXd>(qdd + k * n, n);
#define VECTOR Eigen::Map<Eigen::VectorXd>(out, n)
#define SQUARE Eigen::Map<RowMatrix>(out, n, n)

LOOP(tau, n, VELOCITY ACCELERATION VECTOR = pinocchio::rnea(arm.model, arm.data, arm.q, arm.qd, arm.qdd);)
LOOP(B, n *n, pinocchio::crba(arm.model, arm.data, arm.q);
     SQUARE = arm.data.M.selfadjointView<Eigen::Upper>();)
LOOP(C, n *n, VELOCITY SQUARE = pinocchio::computeCoriolisMatrix(arm.model, arm.data, arm.q, arm.qd);)
LOOP(g, n, VECTOR = pinocchio::computeGeneralizedGravity(arm.model, arm.data, arm.q);)
LOOP(T, 16, pinocchio::framesForwardKinematics(arm.model, arm.data, arm.q);
     Eigen::Map<Transform>(out, 4, 4) = arm.data.oMf[arm.end].toHomogeneousMatrix();)
LOOP(J, 6 * n, arm.jacobian.setZero();
     pinocchio::computeFrameJacobian(arm.model, arm.data, arm.q, arm.end, pinocchio::LOCAL_WORLD_ALIGNED, arm.jacobian);
     Eigen::Map<RowMatrix>(out, 6, n) = arm.jacobian;)
