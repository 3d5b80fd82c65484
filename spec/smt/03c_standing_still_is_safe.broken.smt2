; BROKEN     Twin of 03c_standing_still_is_safe.smt2: a robot that is told to rest creeps.
(set-info :status sat)
(set-logic QF_NRA)

; Symbols
(declare-const A Real)        ; greatest acceleration
(declare-const b Real)        ; least braking, told to rest
(declare-const V Real)        ; greatest speed of the thing's class
(declare-const kappa Real)    ; closing cosine
(declare-const r Real)        ; what is left of the clearance
(declare-const v Real)        ; speed of the robot
(declare-const v1 Real)       ; speed afterwards
(declare-const t Real)        ; time that passes
(declare-const m Real)        ; way of the thing towards the robot
; Formulas
(define-fun safe_need ((v Real)) Real (+ (/ (* kappa v v) (* 2 b)) (/ (* V v) b)))

; Assumptions
(assert (>= A 0))
(assert (> b 0))
(assert (>= V 0))
(assert (<= 0 kappa 1))
(assert (>= v 0))
(assert (>= v1 0))
(assert (>= t 0))
(assert (= v 0))
(assert (<= v1 (+ v (* A t))))                               ; BROKEN: it gains speed although told to rest

; Conclusion, negated
(assert (not (or (= v1 0) (<= (safe_need v1) (- r m)))))
(check-sat)
