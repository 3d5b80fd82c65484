; THEOREM    03c: standing still is always safe.
; ASSUMED    The robot rests, is told to rest and so stays at rest; the thing does what it likes.
; CONCLUDED  The robot is at rest, or the state is safe: the promise holds whatever the clearance,
;            with no guard.
; SOURCE     Mitsch, Ghorbal, Vogelbacher, Platzer, IJRR 36(12), 2017, passive safety: v = 0 or no
;            contact.
; TWIN       a robot that is told to rest creeps.
; SOLVERS    z3 cvc5
(set-info :status unsat)
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
(assert (<= v1 v))

; Conclusion, negated
(assert (not (or (= v1 0) (<= (safe_need v1) (- r m)))))
(check-sat)
